// SPDX-License-Identifier: MIT
#include "pipeline/layers.hpp"

#include <algorithm>
#include <limits>

namespace manylight {

Layers::Layers(const Scene& scene, const RenderOptions& options, const Plan& plan)
    : scene_(scene), has_clusters_(plan.clusters), kept_(plan.batches, false) {
    for (const Aov& aov : all_aovs())
        if (std::ranges::count(options.aovs, aov.name))
            layers_.emplace_back(aov.name, Image(options.width, options.height, aov.channels));
}

void Layers::keep(unsigned number, const Tiles& batch, const Buffer<Material>& materials,
                  const Buffer<Surface>& centres, const LightSampler* sampler) {
    if (kept_[number]) return;
    kept_[number] = true;
    std::size_t next = clusters_;  // number of the next cluster in the whole image
    if (has_clusters_) clusters_ += sampler->cluster_count();
    if (layers_.empty()) return;
    BatchFacts facts;
    facts.origin = scene_.origin;
    facts.materials = materials.download();
    facts.surfaces = centres.download(0, item_count(batch));
    if (has_clusters_) facts.clusters = sampler->cluster_facts();
    for (const uint split : facts.clusters.split) {
        facts.numbers.push_back(next);
        next += split == 0;
    }
    for (auto& [name, layer] : layers_) {
        const Aov& aov = *std::ranges::find(all_aovs(), name, &Aov::name);
        if (aov.fill) fill_layer(aov, facts, batch, layer);
    }
}

void Layers::keep_error(const std::optional<ErrorEstimate>& error) {
    for (auto& [name, layer] : layers_) {
        if (name != "error") continue;
        if (error)
            layer = error->pixels;
        else
            std::ranges::fill(layer.values, std::numeric_limits<float>::quiet_NaN());
    }
}

}  // namespace manylight
