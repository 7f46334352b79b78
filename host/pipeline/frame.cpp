// SPDX-License-Identifier: MIT
#include "pipeline/frame.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include "error.hpp"
#include "stages/accumulate.hpp"
#include "stages/samples.hpp"

namespace manylight {
namespace {

constexpr std::size_t items_per_batch = std::size_t{1} << 18;

// Adds the time until its end to a total, compiling apart.
class Stopwatch {
  public:
    Stopwatch(double& total, const Device& device)
        : total_(total), device_(device), compiled_(device.compile_seconds()) {}
    ~Stopwatch() {
        total_ += std::chrono::duration<double>(Clock::now() - start_).count() -
                  (device_.compile_seconds() - compiled_);
    }

  private:
    using Clock = std::chrono::steady_clock;
    double& total_;
    const Device& device_;
    double compiled_;
    Clock::time_point start_ = Clock::now();
};

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

std::size_t scene_bytes(const Scene& scene, const WideBvh& bvh) {
    return bytes_of(bvh.nodes) + bytes_of(bvh.blocks) + bytes_of(scene.vertices) +
           bytes_of(scene.vertex_normals) + bytes_of(scene.indices) +
           bytes_of(scene.triangle_materials) + bytes_of(scene.materials) + bytes_of(scene.lights);
}

}  // namespace

struct Frame::Stages {
    DeviceScene scene;
    GBufferStage gbuffer;
    SampleStage samples;
    AccumulateStage accumulate;
    std::optional<Clustering> clustering;
    Arguments tables;          // what the sampler draws from
    Buffer<Surface> centres;   // of the pixels, where clusters or AOVs need them
    Buffer<Surface> surfaces;  // of the pixel samples
    Buffer<float4> estimates;
    Buffer<float4> image;

    Stages(Device& device, DeviceScene uploaded, const Sampler& sampler)
        : scene(std::move(uploaded)),
          gbuffer(device, scene),
          samples(device, scene, sampler.kernel_file),
          accumulate(device, scene) {}
};

const std::vector<Aov>& all_aovs() {
    static const std::vector<Aov> aovs = {
        {"normal", {"normal.X", "normal.Y", "normal.Z"}, false, "shading normal, world space"},
        {"depth", {"depth.Z"}, false, "distance from the camera, m; 0 where nothing is hit"},
        {"position", {"position.X", "position.Y", "position.Z"}, false, "world space, m"},
        {"albedo", {"albedo.R", "albedo.G", "albedo.B"}, false, "base colour"},
        {"cluster", {"cluster.Y"}, true, "number of the pixel's cluster"},
        {"representative", {"representative.Y"}, true, "1 at the clusters' representatives"},
        {"visible_share",
         {"visible_share.Y"},
         true,
         "share of the lights facing the representative that it sees"},
        {"lights", {"lights.Y"}, true, "number of lights that contribute to the representative"},
    };
    return aovs;
}

Frame::Frame(const Device& device, const Scene& scene, const WideBvh& bvh, const Camera& camera,
             const RenderOptions& options)
    : device_(device),
      scene_(scene),
      bvh_(bvh),
      camera_(camera),
      options_(options),
      sampler_(find_sampler(options.sampler)),
      jitter_(options.spp > 1 && !options.pixel_centre) {
    for (const Aov& aov : all_aovs())
        if (aov.needs_clusters && std::ranges::count(options_.aovs, aov.name) && !uses_clusters())
            throw InputError("--aov {}: sampler {} makes no clusters", aov.name, sampler_.name);
    const unsigned size = options.clusters.tile_size;
    const Tiles tiles = all_tiles(options.width, options.height, size);
    const std::size_t items = std::size_t{size} * size;
    const auto lights = static_cast<uint>(scene.lights.size());
    plan_.scene_bytes = scene_bytes(scene, bvh);
    plan_.image_bytes = std::size_t{options.width} * options.height * sizeof(float4);
    const bool centres = jitter_ && (uses_clusters() || !options.aovs.empty());
    std::size_t tile_bytes = items * (sizeof(Surface) * (centres ? 2 : 1) + sizeof(float4));
    std::size_t tile_matrix = 0;
    std::size_t most_tiles = std::clamp<std::size_t>(items_per_batch / items, 1, tiles.count);
    if (uses_clusters()) {
        tile_bytes += Clustering::tile_bytes(options.clusters, lights);
        tile_matrix = most_regions(options.clusters) * Matrix::row_bytes(lights);
    } else if (sampler_.table == Table::power) {
        plan_.matrix_bytes = Matrix::row_bytes(lights);
    }
    const DeviceInfo& info = device_.info();
    const std::size_t budget = options.memory > 0
                                   ? options.memory
                                   : std::min<std::size_t>(info.global_memory / 2, 2ull << 30);
    const std::size_t fixed = plan_.scene_bytes + plan_.image_bytes + plan_.matrix_bytes;
    if (fixed + tile_bytes > budget || tile_matrix > info.max_allocation)
        throw InputError(
            "--memory {} MiB is too little: scene {} MiB, image {} MiB, and {} MiB for one tile{}",
            budget >> 20, plan_.scene_bytes >> 20, plan_.image_bytes >> 20, (tile_bytes >> 20) + 1,
            uses_clusters() ? " (a smaller --tile-size or --max-depth needs less)" : "");
    most_tiles = std::min(most_tiles, (budget - fixed) / tile_bytes);
    if (tile_matrix > 0) most_tiles = std::min(most_tiles, info.max_allocation / tile_matrix);
    plan_.tiles_per_batch = static_cast<unsigned>(most_tiles);
    plan_.batches = static_cast<unsigned>((tiles.count + most_tiles - 1) / most_tiles);
    plan_.matrix_bytes += most_tiles * tile_matrix;
    plan_.batch_bytes = most_tiles * tile_bytes;
}

bool Frame::uses_clusters() const {
    return sampler_.table == Table::clusters && !scene_.lights.empty();
}

uint Frame::light_samples() const {
    const auto lights = static_cast<uint>(scene_.lights.size());
    return sampler_.all_lights || lights == 0 ? lights : options_.light_samples;
}

Mixture Frame::mixture() const {
    double total = 0;
    for (const Light& light : scene_.lights) total += light.emission.w;
    const Shares& shares = sampler_.shares;
    return {shares.visible, shares.unshadowed, shares.power, static_cast<float>(total)};
}

void Frame::prepare() {
    stages_ =
        std::make_shared<Stages>(device_, upload_scene(device_, scene_, bvh_, camera_), sampler_);
    Stages& s = *stages_;
    const std::size_t items = std::size_t{plan_.tiles_per_batch} * options_.clusters.tile_size *
                              options_.clusters.tile_size;
    s.surfaces = device_.allocate<Surface>(items);
    const bool centres = uses_clusters() || !options_.aovs.empty();
    if (centres) s.centres = jitter_ ? device_.allocate<Surface>(items) : s.surfaces;
    s.estimates = device_.allocate<float4>(items);
    s.estimates.clear();
    s.image = device_.allocate<float4>(std::size_t{options_.width} * options_.height);
    s.image.clear();
    if (uses_clusters()) {
        s.clustering.emplace(device_, s.scene, options_.clusters, plan_.tiles_per_batch);
        s.tables = s.clustering->tables();
    } else if (sampler_.table == Table::power && light_samples() > 0) {
        Stopwatch watch(result_.prepare_seconds, device_);
        Matrix row(device_, 1, s.scene.light_count);
        row.values.clear();
        row.totals.clear();
        PdfStage(device_, s.scene).normalise(1, mixture(), row);
        device_.finish();
        s.tables.set("power_cdf", row.values);
    }
}

FrameResult Frame::render(Progress& progress) {
    Stages& s = *stages_;
    for (const Aov& aov : all_aovs())
        if (std::ranges::count(options_.aovs, aov.name))
            result_.aovs.emplace_back(aov.name,
                                      Image(options_.width, options_.height, aov.channels));
    Tiles batch = all_tiles(options_.width, options_.height, options_.clusters.tile_size);
    const uint tiles = batch.count;
    for (; batch.first < tiles; batch.first += plan_.tiles_per_batch) {
        batch.count = std::min(plan_.tiles_per_batch, tiles - batch.first);
        if (s.centres.size() > 0) {
            Stopwatch watch(result_.prepare_seconds, device_);
            s.gbuffer.trace(batch, {}, s.centres);
            if (jitter_) result_.primary_rays += item_count(batch);
            if (uses_clusters()) cluster(batch, s.centres, progress);
            keep_aovs(batch, s.centres);
            device_.finish();
        }
        Stopwatch watch(result_.render_seconds, device_);
        sample(batch, progress);
    }
    Stopwatch watch(result_.render_seconds, device_);
    result_.image = Image(options_.width, options_.height, {"R", "G", "B"});
    const std::vector<float4> sums = s.image.download();
    double rays = 0;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        for (int c = 0; c < 3; ++c)
            result_.image.values[3 * i + c] = sums[i][c] / static_cast<float>(options_.spp);
        rays += sums[i].w;
    }
    result_.shadow_rays += static_cast<std::size_t>(rays);
    return std::move(result_);
}

void Frame::cluster(const Tiles& batch, const Buffer<Surface>& surfaces, Progress& progress) {
    Clustering& clustering = *stages_->clustering;
    const auto tiles = static_cast<double>(
        all_tiles(options_.width, options_.height, options_.clusters.tile_size).count);
    // How many rays clusters take shows only as they are made: count towards half of their worst.
    const double worst = static_cast<double>(batch.count) * most_regions(options_.clusters) *
                         stages_->scene.light_count;
    const double samples = static_cast<double>(item_count(batch)) * options_.spp * light_samples();
    double done = 0;
    clustering.build(batch, surfaces, [&](std::size_t entries) {
        device_.finish();
        done += static_cast<double>(entries);
        progress.set(
            (batch.first + batch.count * std::min(done, worst / 2) / (worst / 2 + samples)) /
            tiles);
    });
    for (const RowSum& total : clustering.totals()) result_.shadow_rays += total.facing_count;
    for (const uint split : clustering.split()) result_.clusters += split == 0;
    clustering.normalise(mixture());
}

void Frame::sample(const Tiles& batch, Progress& progress) {
    Stages& s = *stages_;
    const auto tiles = static_cast<double>(
        all_tiles(options_.width, options_.height, options_.clusters.tile_size).count);
    const double all =
        static_cast<double>(item_count(batch)) * options_.spp * std::max(light_samples(), 1u);
    double done = 0;
    for (uint i = 0; i < options_.spp; ++i) {
        const PixelSample sample{i, options_.seed, jitter_};
        const bool traced = !jitter_ && (i > 0 || s.centres.size() > 0);
        if (!traced) s.gbuffer.trace(batch, sample, s.surfaces);
        if (!traced || i == 0) result_.primary_rays += item_count(batch);
        s.samples.draw(batch, sample, light_samples(), s.surfaces, s.tables, s.estimates,
                       [&](std::size_t samples) {
                           device_.finish();
                           done += static_cast<double>(samples);
                           progress.set((batch.first + batch.count * done / all) / tiles);
                       });
        s.accumulate.add(batch, s.surfaces, s.estimates, s.image);
    }
    device_.finish();
}

void Frame::keep_aovs(const Tiles& batch, const Buffer<Surface>& surfaces) {
    if (result_.aovs.empty()) return;
    const std::vector<Surface> points = surfaces.download(0, item_count(batch));
    std::vector<uint> rows;
    std::vector<uint> representatives;
    std::vector<RowSum> totals;
    std::vector<uint> numbers;  // [region] the leaf's number in the whole image
    if (uses_clusters()) {
        const Clustering& clustering = *stages_->clustering;
        rows = clustering.item_rows();
        representatives = clustering.representatives();
        totals = clustering.totals();
        auto next = static_cast<uint>(result_.clusters);
        for (const uint split : clustering.split()) next -= split == 0;
        for (const uint split : clustering.split()) numbers.push_back(split == 0 ? next++ : 0);
    }
    const auto fill = [&](std::size_t item, std::string_view name, float* out) {
        const Surface& p = points[item];
        const bool hit = p.position.w >= 0;
        const uint row = rows.empty() ? 0 : rows[item];
        const auto vector = [&](const float4& v) {
            for (int c = 0; c < 3; ++c) out[c] = hit ? v[c] : 0;
        };
        if (name == "normal") vector(p.normal);
        if (name == "depth") *out = hit ? p.position.w : 0;
        if (name == "position") vector(p.position);
        if (name == "albedo") vector(hit ? scene_.materials[p.material].base_color : float4(0));
        if (name == "cluster") *out = static_cast<float>(numbers[row]);
        if (name == "representative") *out = representatives[row] == item ? 1.f : 0.f;
        if (name == "visible_share")
            *out = totals[row].facing_count == 0
                       ? 0.f
                       : static_cast<float>(totals[row].visible_count) / totals[row].facing_count;
        if (name == "lights") *out = static_cast<float>(totals[row].visible_count);
    };
    for (auto& [name, image] : result_.aovs)
        for (std::size_t item = 0; item < points.size(); ++item) {
            const glm::uvec2 pixel = item_pixel(batch, item);
            if (pixel.x < options_.width && pixel.y < options_.height)
                fill(item, name, image.at(pixel.x, pixel.y));
        }
}

}  // namespace manylight
