// SPDX-License-Identifier: MIT
#include "support.hpp"

namespace manylight {

// Each stage of sampler adaptive on each scene, with every light a node and with groups of lights.
TEST(adaptive, stages_agree_with_the_reference) {
    FOR_EACH_DEVICE(device)
    for (const std::string& scene : test::scene_names())
        for (const uint cut_size : {5u, 40u, 256u}) {
            SCOPED_TRACE(fmt::format("{}, cuts of {}", scene, cut_size));
            for (const Check& check : test::verifier(scene, device).adaptive(cut_size))
                test::expect_pass(check);
        }
}

}  // namespace manylight
