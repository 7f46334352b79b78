// SPDX-License-Identifier: MIT
#include "pipeline/aov.hpp"

namespace manylight {
namespace {

bool hit(const BatchFacts& f, std::size_t item) { return f.surfaces[item].position.w >= 0; }

void copy(const float4& v, float* out) {
    for (int c = 0; c < 3; ++c) out[c] = v[c];
}

const RowSum& total(const BatchFacts& f, std::size_t item) {
    return f.clusters.totals[f.clusters.rows[item]];
}

void normal(const BatchFacts& f, std::size_t item, float* out) {
    if (hit(f, item)) copy(f.surfaces[item].normal, out);
}

void depth(const BatchFacts& f, std::size_t item, float* out) {
    if (hit(f, item)) *out = f.surfaces[item].position.w;
}

void position(const BatchFacts& f, std::size_t item, float* out) {
    if (!hit(f, item)) return;
    const float4& p = f.surfaces[item].position;
    copy(float4(f.origin + glm::dvec3(p.x, p.y, p.z), 0), out);
}

void albedo(const BatchFacts& f, std::size_t item, float* out) {
    if (hit(f, item)) copy(f.materials[f.surfaces[item].shading].base_color, out);
}

void cluster(const BatchFacts& f, std::size_t item, float* out) {
    *out = static_cast<float>(f.numbers[f.clusters.rows[item]]);
}

void representative(const BatchFacts& f, std::size_t item, float* out) {
    *out = f.clusters.representatives[f.clusters.rows[item]] == item ? 1.f : 0.f;
}

void visible_share(const BatchFacts& f, std::size_t item, float* out) {
    const RowSum& t = total(f, item);
    if (t.facing_count > 0)
        *out = static_cast<float>(t.visible_count) / static_cast<float>(t.facing_count);
}

void lights(const BatchFacts& f, std::size_t item, float* out) {
    *out = static_cast<float>(total(f, item).visible_count);
}

}  // namespace

const std::vector<Aov>& all_aovs() {
    static const std::vector<Aov> aovs = {
        {"normal",
         {"normal.X", "normal.Y", "normal.Z"},
         false,
         "shading normal, world space; like all layers 0 where nothing is hit",
         normal},
        {"depth", {"depth.Z"}, false, "distance from the camera, m", depth},
        {"position",
         {"position.X", "position.Y", "position.Z"},
         false,
         "in the file's frame, m",
         position},
        {"albedo", {"albedo.R", "albedo.G", "albedo.B"}, false, "base colour", albedo},
        {"cluster", {"cluster.Y"}, true, "number of the pixel's cluster", cluster},
        {"representative",
         {"representative.Y"},
         true,
         "1 at the clusters' representatives",
         representative},
        {"visible_share",
         {"visible_share.Y"},
         true,
         "share of the lights facing the representative that it sees",
         visible_share},
        {"lights",
         {"lights.Y"},
         true,
         "number of lights that contribute to the representative",
         lights},
        {"error",
         {"error.R", "error.G", "error.B"},
         false,
         "estimated squared error relative to the pixel, whose mean is the image's relMSE",
         nullptr},
    };
    return aovs;
}

void fill_layer(const Aov& aov, const BatchFacts& facts, const Tiles& batch, Image& layer) {
    for (std::size_t item = 0; item < facts.surfaces.size(); ++item) {
        const glm::uvec2 pixel = item_pixel(batch, item);
        if (pixel.x < layer.width && pixel.y < layer.height)
            aov.fill(facts, item, layer.at(pixel.x, pixel.y));
    }
}

}  // namespace manylight
