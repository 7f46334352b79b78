// SPDX-License-Identifier: MIT
// The GGX lobe, as appendix B of the glTF 2.0 specification writes it.
#pragma once

#include <glm/glm.hpp>

namespace manylight::reference {

/// D V: microfacet distribution times visibility, 1/sr, without Fresnel's term, of the cosines of
/// the normal with half vector, light and viewer.
[[nodiscard]] double ggx_lobe(double alpha, double n_h, double n_l, double n_v);

/// The same, of squared width a2 (alpha squared, and more where a lobe is widened by the spread of
/// what it reflects).
[[nodiscard]] double widened_ggx_lobe(double a2, double n_h, double n_l, double n_v);

/// The density, 1/sr, of directions in which the viewer is mirrored at one of the microfacets that
/// it sees: Heitz (2018), eq. 17: G1 D / (4 N.V), where G1 is 2 N.V / (N.V + root).
[[nodiscard]] double ggx_density(double alpha, double n_h, double n_v);

/// (1 - cosine)^5, of the cosine of the half vector with the viewer: Schlick's part of Fresnel's
/// terms.
[[nodiscard]] double schlick_part(double cosine);

/// A unit direction drawn from the GGX lobe about unit `normal` for a viewer in unit direction
/// `wo`, whose cosine is positive, with the density that ggx_density() gives; `u` in [0, 1)^2.
/// Visible normals (Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7:4, 2018) as
/// points of spherical caps (Dupuy and Benyoub, 2023).
[[nodiscard]] glm::dvec3 sample_lobe(double alpha, const glm::dvec3& normal, const glm::dvec3& wo,
                                     const glm::dvec2& u);

/// The light samples' share of what the lobe reflects of a point of a light's cell (area x cosine /
/// squared distance = `solid_angle`, sr), where reflected directions have `density`, 1/sr: the
/// power heuristic (Veach and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo
/// Rendering", 1995) for `count` samples of the light and one of the lobe.
[[nodiscard]] double light_share(double density, double solid_angle, double count);

}  // namespace manylight::reference
