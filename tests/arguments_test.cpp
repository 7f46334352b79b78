// SPDX-License-Identifier: MIT
#include <array>
#include <stdexcept>

#include "shared/surface.h"
#include "support.hpp"

namespace manylight {

TEST(arguments, types_have_their_names_in_opencl) {
    EXPECT_EQ(opencl_name(typeid(float)), "float");
    EXPECT_EQ(opencl_name(typeid(uint)), "uint");
    EXPECT_EQ(opencl_name(typeid(int)), "int");
    EXPECT_EQ(opencl_name(typeid(float4)), "float4");
    EXPECT_EQ(opencl_name(typeid(std::array<uint, 4>)), "uint4");
    EXPECT_EQ(opencl_name(typeid(Surface)), "Surface");
}

TEST(arguments, of_another_type_than_the_parameter_are_refused) {
    FOR_EACH_DEVICE(each) {
        Device device = each;
        Kernel probe = device.kernel("probe.cl", "probe_random", {}, "probe");
        Arguments arguments;
        arguments.set("count", 1u)
            .set("seed", 1u)
            .set("bits", device.allocate<uint>(4))
            .set("positions", device.allocate<float>(2));
        probe.launch(1, arguments);  // vectors and the numbers that they are of are alike
        device.finish();
        const auto refusal_of = [&](const char* name, const auto& value) -> std::string {
            Arguments wrong = arguments;
            wrong.set(name, value);
            try {
                probe.launch(1, wrong);
            } catch (const std::logic_error& error) {
                return error.what();
            }
            return "none";
        };
        const std::string start = "kernel probe_random: argument ";
        EXPECT_EQ(refusal_of("seed", 1.f), start + "'seed' is a uint, not a float");
        EXPECT_EQ(refusal_of("seed", 1), start + "'seed' is a uint, not a int");
        EXPECT_EQ(refusal_of("bits", device.allocate<float>(4)),
                  start + "'bits' is a uint4*, not a buffer of float");
        EXPECT_EQ(refusal_of("bits", 1u), start + "'bits' is a uint4*, not a uint");
        EXPECT_EQ(refusal_of("count", device.allocate<uint>(4)),
                  start + "'count' is a uint, not a buffer of uint");
    }
}

}  // namespace manylight
