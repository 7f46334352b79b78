// SPDX-License-Identifier: MIT
// Stage random: random numbers, and where in pixels rays start.
#include <array>

#include "reference/random.hpp"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

Check random(Verifier& verifier) {
    Check check{.stage = "random", .tolerance = exact};
    const uint count = 4096;
    Buffer<std::array<uint, 4>> bits = verifier.device().allocate<std::array<uint, 4>>(count);
    Buffer<glm::vec2> positions = verifier.device().allocate<glm::vec2>(count);
    verifier.device()
        .kernel("probe.cl", "probe_random", {}, "probe")
        .launch(count, Arguments()
                           .set("count", count)
                           .set("seed", verifier.options().seed)
                           .set("bits", bits)
                           .set("positions", positions));
    const auto found_bits = bits.download();
    const auto found_positions = positions.download();
    for (uint i = 0; i < count; ++i) {
        check.compare_exact(
            found_bits[i] == reference::random_bits(i, i ^ 5, i * 7, verifier.options().seed),
            fmt::format("random_bits of item {}", i));
        check.compare_exact(glm::dvec2(found_positions[i]) ==
                                reference::pixel_position(i / 16, i, verifier.options().seed),
                            fmt::format("pixel_position of item {}", i));
    }
    return check;
}

}  // namespace

StageCheck check_random() { return {.stages = {"random"}, .run = single<random>}; }

}  // namespace manylight
