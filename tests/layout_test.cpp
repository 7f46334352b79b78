// SPDX-License-Identifier: MIT
#include "support.hpp"

namespace manylight {

TEST(layout, device_agrees_on_every_field) {
    FOR_EACH_DEVICE(device) test::expect_stage("layout", test::verifier("points", device));
}

}  // namespace manylight
