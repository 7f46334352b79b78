// SPDX-License-Identifier: MIT
#include "explain/inspect.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "lights/lights.hpp"
#include "reference/adaptive.hpp"
#include "reference/gbuffer.hpp"
#include "reference/tiles.hpp"

namespace manylight {
namespace {

constexpr std::size_t most_points = 256;
constexpr std::size_t most_rays = std::size_t{1} << 18;

// Evaluates lights at one point.
class Truth {
  public:
    Truth(const LightTree& tree, const reference::Tracer& tracer, const reference::Point& point)
        : tree_(tree), tracer_(tracer), point_(point) {
        const std::size_t points = most_rays / std::max<std::size_t>(tree.lights.size(), 1);
        points_ = static_cast<uint>(std::clamp<std::size_t>(points, 1, most_points));
    }

    // Of the lights of a node, drawn child by child as the sampler does.
    struct Sum {
        glm::dvec3 value{0};  // cd/m2
        double square = 0;    // expected, of the luminance of light / probability
        uint facing = 0;
        uint seen = 0;
    };
    void add_node(uint node, double probability, Sum& sum) const {
        if (tree_.nodes[node].count == 1) return add_light(node, probability, sum);
        const uint children[] = {node + 1, node + 2 * tree_.nodes[node + 1].count};
        double estimates[2];
        for (int i = 0; i < 2; ++i)
            estimates[i] =
                reference::luminance(reference::node_estimate(tree_, children[i], point_));
        const double both = estimates[0] + estimates[1];
        for (int i = 0; i < 2; ++i)
            add_node(children[i], both > 0 ? probability * estimates[i] / both : 0, sum);
    }

    [[nodiscard]] uint points() const { return points_; }

  private:
    void add_light(uint node, double probability, Sum& sum) const {
        const Light& light = tree_.lights[tree_.nodes[node].first];
        const uint count = light_has(light, TRAIT_AREA) ? points_ : 1;
        const double part = 1.0 / count;
        bool facing = false;
        bool seen = false;
        for (uint i = 0; i < count; ++i) {
            // Roberts' R2 sequence.
            const glm::dvec2 u = glm::fract(
                0.5 + static_cast<double>(i) * glm::dvec2(0.7548776662466927, 0.5698402909980532));
            const reference::Unshadowed term =
                reference::unshadowed(point_.surface, point_.material(), point_.viewer, light, u);
            if (term.value == glm::dvec3(0)) continue;
            facing = true;
            if (tracer_.occluded(term.shadow)) continue;
            seen = true;
            sum.value += part * term.value;
            if (probability > 0)
                sum.square += part * std::pow(reference::luminance(term.value), 2) / probability;
        }
        sum.facing += facing;
        sum.seen += seen;
    }

    const LightTree& tree_;
    const reference::Tracer& tracer_;
    const reference::Point& point_;
    uint points_;
};

// The variance of a sum over nodes drawn by systematic sampling: node i, with the expected number
// of draws shares[i], adds values[i] each time and is drawn
// floor(u + reached[i]) - floor(u + reached[i - 1]) times, u uniform in [0, 1).
double systematic_variance(const std::vector<double>& shares, const std::vector<double>& values) {
    std::vector<double> reached(shares.size());
    std::partial_sum(shares.begin(), shares.end(), reached.begin());
    std::vector<double> starts = {0, 1};  // between which the same nodes are drawn
    for (const double r : reached) starts.push_back(std::ceil(r) - r);
    std::ranges::sort(starts);
    double mean = 0;
    double square = 0;
    for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
        const double length = starts[k + 1] - starts[k];
        const double u = starts[k] + length / 2;
        double sum = 0;
        double before = 0;
        for (std::size_t i = 0; i < shares.size(); ++i) {
            const double after = std::floor(u + reached[i]);
            sum += (after - before) * values[i];
            before = after;
        }
        mean += length * sum;
        square += length * sum * sum;
    }
    return std::max(square - mean * mean, 0.0);
}

// Shares of the nodes in the pixel's variance, by Hajek's approximation for unequal inclusion
// probabilities ("Asymptotic Theory of Rejective Sampling with Varying Probabilities", 1964). With
// p the fraction of a node's expected number of draws, the inclusion probability of its last draw,
// a node's variance is p (1 - p) (value - mean)^2 plus its variance within, that of drawing one of
// its lights and a point on it; mean is the mean of all values, weighted by p (1 - p). The variance
// of the number of all draws x mean^2 is count_noise.
void set_noise(const std::vector<double>& shares, const std::vector<double>& values,
               const std::vector<double>& within, PixelReport& out) {
    const auto spread = [](double share) {
        const double rest = share - std::floor(share);
        return rest * (1 - rest);
    };
    double all = 0;
    double mean = 0;
    for (std::size_t i = 0; i < shares.size(); ++i) {
        all += spread(shares[i]);
        mean += spread(shares[i]) * values[i];
    }
    if (all > 0) mean /= all;
    out.count_noise = spread(std::accumulate(shares.begin(), shares.end(), 0.0)) * mean * mean;
    double sum = out.count_noise;
    for (std::size_t i = 0; i < shares.size(); ++i) {
        out.nodes[i].noise = spread(shares[i]) * std::pow(values[i] - mean, 2) + within[i];
        sum += out.nodes[i].noise;
    }
    if (sum == 0) return;
    out.count_noise /= sum;
    for (InspectedNode& node : out.nodes) node.noise /= sum;
}

// The pixels that are drawn together with a pixel: the same place of cells beside its own.
struct Group {
    std::vector<Surface> surfaces;
    std::vector<reference::DrawnPixel> pixels;
    std::size_t own;
};

// `varied`: gets the pixels' own materials, if there are any.
Group find_group(const Scene& scene, std::optional<Scene>& varied, const reference::Tracer& tracer,
                 const Camera& camera, const Tiles& tiles, glm::uvec2 pixel,
                 const TileKnowledge& knowledge) {
    const std::size_t item = reference::item_of(tiles, pixel.x, pixel.y);
    const std::size_t cell = item / 16 % CELLS_PER_TILE;
    Group out{std::vector<Surface>(knowledge.together), {}, cell % knowledge.together};
    for (std::size_t i = 0; i < out.surfaces.size(); ++i) {
        const std::size_t own_cell = cell - out.own + i;
        const glm::uvec2 at = item_pixel(tiles, item - 16 * out.own + 16 * i);
        Surface& surface = out.surfaces[i];
        surface.position.w = -1;
        if (at.x < tiles.width && at.y < tiles.height) {
            const reference::Ray ray = reference::primary_ray(camera, tiles, glm::dvec2(at) + 0.5);
            const auto hit = tracer.closest_hit(ray);
            surface = reference::surface_at(scene, ray, hit);
            if (varied) reference::own_material(*varied, ray, hit, surface);
        }
        reference::DrawnPixel& drawn = out.pixels.emplace_back(
            surface.position.w >= 0 ? &surface : nullptr, camera, reference::Starts{0, 0.5});
        for (std::size_t slot = 0; slot < knowledge.cut.size(); ++slot)
            drawn.visible.push_back(knowledge.visible[64 * slot + own_cell]);
    }
    return out;
}

}  // namespace

double PixelReport::draws() const {
    double sum = 0;
    for (const InspectedNode& node : nodes) sum += node.draws;
    return sum;
}

PixelReport inspect_pixel(const Scene& plain, const LightTree& tree, const Camera& camera,
                          const Tiles& tiles, glm::uvec2 pixel, const TileKnowledge& knowledge) {
    std::optional<Scene> varied;
    const Scene& scene = plain.varies_materials() ? varied.emplace(plain) : plain;
    const reference::Tracer tracer(scene);
    const Group group = find_group(scene, varied, tracer, camera, tiles, pixel, knowledge);
    PixelReport out;
    out.pixel = pixel;
    out.tile = pixel.y / tiles.size * tiles.columns + pixel.x / tiles.size;
    out.surface = group.surfaces[group.own];
    if (!out.hit()) return out;
    out.material = scene.materials[out.surface.shading];
    out.cut_nodes = static_cast<uint>(knowledge.cut.size());
    for (const uint node : knowledge.cut) out.cut_lights += tree.nodes[node].count == 1;

    const std::vector<reference::Drawn> choices =
        reference::draw_nodes(tree, scene, knowledge.cut, group.pixels, knowledge.budget)[group.own]
            .nodes;
    const reference::Point point{scene, camera, out.surface};
    const Truth truth(tree, tracer, point);
    out.area_points = truth.points();
    std::vector<double> shares;
    std::vector<double> values;  // of a draw: what it adds to the pixel, on average
    std::vector<double> within;  // variance of what a node's draws add, by the choice of a light
    for (const reference::Drawn& choice : choices) {
        Truth::Sum sum;
        truth.add_node(choice.node, 1, sum);
        const double visible = group.pixels[group.own].visible[choice.slot];
        const double contribution = reference::luminance(sum.value);
        const double expected = CONTROL * reference::known_visibility(visible) * choice.estimate;
        shares.push_back(choice.share);
        values.push_back(choice.share > 0 ? (contribution - expected) / choice.share : 0);
        within.push_back(choice.share > 0
                             ? std::max(sum.square - contribution * contribution, 0.0) /
                                   choice.share
                             : 0);
        out.radiance += sum.value;
        out.nodes.push_back({choice.node, choice.weight, std::abs(visible),
                             knowledge.rounds * choice.share, contribution, sum.facing, sum.seen,
                             0});
    }
    out.variance =
        (systematic_variance(shares, values) + std::accumulate(within.begin(), within.end(), 0.0)) /
        knowledge.rounds;

    set_noise(shares, values, within, out);
    return out;
}

}  // namespace manylight
