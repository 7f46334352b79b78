// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "reference/tracing.hpp"
#include "shared/camera.h"
#include "shared/surface.h"

namespace manylight::reference {

/// glTF 2.0 appendix B with KHR_materials_specular's factor; unit directions away from the surface.
struct Brdf {
    glm::dvec3 diffuse{0}, specular{0};  // Lambert's part and the GGX lobe's, 1/sr
    double density = 0;  // of wi, 1/sr, where wo is mirrored at one of the microfacets that it sees
};
[[nodiscard]] Brdf split_brdf(const Material& material, const glm::dvec3& normal,
                              const glm::dvec3& wi, const glm::dvec3& wo);

/// Both parts.
[[nodiscard]] glm::dvec3 brdf(const Material& material, const glm::dvec3& normal,
                              const glm::dvec3& wi, const glm::dvec3& wo);

/// Where the light of a surface point goes, and what of it counts: to a camera, all of it, or along
/// a direction, times a throughput.
class Viewer {
  public:
    Viewer(const Camera& camera)  // NOLINT: a camera is one
        : from_(camera.forward.w != 0 ? -glm::dvec3(camera.forward) : glm::dvec3(camera.origin)),
          is_far_(camera.forward.w != 0),
          place_(camera.origin) {}
    explicit Viewer(const Outgoing& outgoing)
        : from_(outgoing.direction), is_far_(true), throughput_(outgoing.throughput) {}

    /// Unit direction from a point.
    [[nodiscard]] glm::dvec3 direction(const glm::dvec3& position) const {
        return is_far_ ? from_ : glm::normalize(from_ - position);
    }
    [[nodiscard]] const glm::dvec3& throughput() const { return throughput_; }
    /// Of the camera from a point, m.
    [[nodiscard]] double distance(const glm::dvec3& position) const {
        return place_ ? glm::length(*place_ - position) : 0;
    }

  private:
    glm::dvec3 from_;  // unit direction, or the camera's position
    bool is_far_;
    std::optional<glm::dvec3> place_;  // of the camera
    glm::dvec3 throughput_{1};
};

/// The viewers of a batch's items: one camera, or one of each.
class Viewers {
  public:
    Viewers(const Camera& camera) : camera_(camera) {}  // NOLINT: a camera is one
    /// outgoing[item].
    explicit Viewers(std::vector<Outgoing> outgoing) : outgoing_(std::move(outgoing)) {}

    [[nodiscard]] Viewer of(std::size_t item) const {
        return outgoing_.empty() ? Viewer(camera_) : Viewer(outgoing_[item]);
    }

  private:
    Camera camera_{};
    std::vector<Outgoing> outgoing_;
};

/// How far single precision moves the start of a surface's shadow rays along each axis, m: by a
/// unit in the last place, for the product with the normal and the sum.
[[nodiscard]] glm::dvec3 origin_rounding(const Surface& surface, const glm::dvec3& origin);

/// Whether stage reflections takes part in what the lobe reflects of area lights.
[[nodiscard]] bool reflects(const Surface& surface, const Material& material, const Viewer& viewer);

/// Direct light of one light, or of its point u in [0, 1)^2, without visibility and without what is
/// left to stage reflections, where `count` light samples are expected on the light.
struct Unshadowed {
    glm::dvec3 value;  // f Le G of paper eq. (1) times the throughput, cd/m2
    Ray shadow;        // the segment to be free
    // How far single precision moves its ends: see origin_rounding(); an area's point by 4 units in
    // the last place of the area's coordinates, being a sum of products, and, as it is off along
    // the area's normal, by what rounding does to that.
    EndShifts rounding;
};
[[nodiscard]] Unshadowed unshadowed(const Surface& surface, const Material& material,
                                    const Viewer& viewer, const Light& light, const glm::dvec2& u,
                                    double count = 1);

[[nodiscard]] inline bool has_area(const Light& light) {
    return light_has(static_cast<uint>(light.position.w), TRAIT_AREA);
}

/// By how much rounding to single precision can change the value of unshadowed(): the changes under
/// shifts of the position along each axis by 8 units in the last place of the coordinates and of
/// the distance to the light, and under the light's own (light_shifts()), added up.
[[nodiscard]] double rounding_slack(const Surface& surface, const Material& material,
                                    const Viewer& viewer, const Light& light, const glm::dvec2& u,
                                    double count = 1);

[[nodiscard]] inline double luminance(const glm::dvec3& rgb) {
    return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
}

}  // namespace manylight::reference
