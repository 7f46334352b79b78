// SPDX-License-Identifier: MIT
#include "support.hpp"

namespace manylight {

TEST(accumulate, agrees_with_the_reference) {
    FOR_EACH_DEVICE(device)
    for (const std::string& scene : test::scene_names()) {
        SCOPED_TRACE(scene);
        test::expect_stage("accumulate", test::verifier(scene, device));
    }
}

}  // namespace manylight
