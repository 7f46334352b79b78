// SPDX-License-Identifier: MIT
// What the program's subcommands do; options/ parses their arguments.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "chart/measure.hpp"
#include "pipeline/frame.hpp"
#include "scene/builtin/builtin.hpp"
#include "scene/gltf/load.hpp"
#include "verify/selection.hpp"

namespace manylight {

/// Whether the camera has a light of its own; automatic: where nothing else shows (is_dark()).
enum class Headlight { never, automatic, always };

/// What every command that loads a scene and opens a device takes.
struct SceneArguments {
    std::string file;
    std::string camera;
    std::optional<unsigned> emitter_points;
    std::optional<double> seconds;  // of the file's first animation; none: at rest
    double lamp_scale = 1;          // of punctual lights' intensities
    Headlight headlight = Headlight::automatic;
    bool cull_back_faces = false;
    std::string variant;  // of materials; empty: the file's own
    MeshStorage storage = MeshStorage::automatic;
    std::string device;
    unsigned threads = 0;
    unsigned lanes = 0;                        // 0: the form that suits the device
    unsigned width = 0;                        // 0: from the height and the camera's aspect
    unsigned height = 0;                       // 0: likewise, or 512
    std::pair<double, double> shift = {0, 0};  // of the image, pixels to the right and down
};

struct RenderArguments {
    SceneArguments scene;
    std::string sampler = "auto";
    RenderOptions options;  // but for the sampler
    std::optional<uint> spp;
    double seconds = 0;  // to render in, from the program's start; 0: as long as it takes
    std::vector<std::string> outputs;
    std::optional<float> exposure;   // stops over the scene's units; otherwise automatic
    std::string cluster_map;         // .png
    std::string checkpoint;          // file to save the render's state to
    double checkpoint_seconds = 60;  // between two times
    bool resume = false;             // from the checkpoint, if there is one
    std::string like;                // image whose render is repeated
    bool repeats_aovs = false;       // the layers are that image's
    unsigned top_lights = 0;         // to report; 0: none
    std::string stats;
    bool quiet = false;
};

struct InspectArguments {
    SceneArguments scene;
    RenderOptions options;  // light_samples, spp, seed, memory
    unsigned x = 0;         // the pixel, from the top left
    unsigned y = 0;
    unsigned top_lights = 16;
    std::string output;  // .png; empty: named after the scene
    std::string json;    // file
};

struct VerifyArguments {
    SceneArguments scene;  // no file: scenes of the program's own
    ClusterOptions clusters;
    uint seed = 1;
    std::string json;  // file, or - for standard output
    Selection only;
};

struct BuiltinArguments {
    std::string name;
    std::string output;
    BuiltinOptions options;
    bool list = false;  // print all scenes, with their parameters, instead
};

struct BenchArguments {
    std::string what;      // traversal, stages, or a scene file for both
    bool loading = false;  // measure a file's loading instead
    SceneArguments scene;
    std::string mesh;
    std::string view;  // far (the default) or close
    std::string sampler = "adaptive";
    uint light_samples = 16;
    std::string json;  // file
    unsigned rounds = 7;
    unsigned bvh_width = 0;  // 0: what suits the device
    unsigned bvh_block = 0;
};

struct CompareArguments {
    std::vector<std::string> images;  // to judge
    std::string reference;            // what they are judged by
    std::string output;               // .png, picture of the errors
    bool json = false;
};

struct ChartArguments {
    SceneArguments scene;
    ChartOptions options;
    std::size_t memory = 0;  // see RenderOptions
    std::string output;      // folder; empty: named after the scene
};

// Each returns the program's exit status and throws InputError or RuntimeError.
int run_render(const RenderArguments& arguments);
int run_inspect(const InspectArguments& arguments);
int run_verify(const VerifyArguments& arguments);
int run_scene(const BuiltinArguments& arguments);
int run_devices();
int run_samplers(bool as_json);
int run_bench(const BenchArguments& arguments);
int run_chart(const ChartArguments& arguments);
int run_compare(const CompareArguments& arguments);

/// Parses the command line and runs what it asks for.
int run_program(int argc, char** argv);

/// A scene with its lights, seen by a camera.
struct LoadedScene {
    Scene scene;
    View view;
    Camera camera;
    unsigned width, height;
    unsigned emitter_points;  // as made; 0: area lights
    bool headlight;           // whether the camera has one
};

/// Loads a scene, makes its emitters lights and finds the camera; prints the file's warnings.
/// Shows its progress unless `quiet`.
[[nodiscard]] LoadedScene load(const SceneArguments& arguments, bool quiet = false);

/// Throws InputError if a file to write is one that the scene names.
void refuse_scene_file(const Scene& scene, const std::string& option, const std::string& path);

/// The BVH that suits a device. Shows its progress unless `quiet`.
[[nodiscard]] WideBvh build_bvh(const LoadedScene& loaded, const Device& device,
                                bool quiet = false);

/// Estimates the `count` lights that give the image most (see find_top_lights) and, unless `quiet`,
/// prints them as a table. Returns the same for --stats.
[[nodiscard]] nlohmann::json report_top_lights(const LoadedScene& loaded, unsigned count, uint seed,
                                               bool quiet);

}  // namespace manylight
