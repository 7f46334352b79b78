// SPDX-License-Identifier: MIT
#include "reference/random.hpp"

#include <set>

#include "support.hpp"

namespace manylight {

TEST(random, device_gives_the_reference_numbers) {
    FOR_EACH_DEVICE(device) test::expect_stage("random", test::verifier("points", device));
}

// Chi-squared of each of the four words' top 4 bits, over each input counted up alone.
TEST(random, bits_are_uniform_along_every_input) {
    constexpr int draws = 1 << 14;
    for (int input = 0; input < 4; ++input) {
        std::array<std::array<int, 16>, 4> counts{};
        for (uint i = 0; i < draws; ++i) {
            uint in[4] = {17, 3, 5, 1};
            in[input] += i;
            const auto bits = reference::random_bits(in[0], in[1], in[2], in[3]);
            for (int word = 0; word < 4; ++word) ++counts[word][bits[word] >> 28];
        }
        for (int word = 0; word < 4; ++word) {
            double x = 0;
            for (const int count : counts[word])
                x += std::pow(count - draws / 16., 2) / (draws / 16.);
            EXPECT_GT(test::chi_squared_tail(x, 15), 1e-4)
                << "input " << input << ", word " << word;
        }
    }
}

// Owen-scrambled Sobol: the first 16 points hit each cell of 4 x 4, 16 x 1 and 1 x 16 once.
TEST(random, pixel_positions_are_stratified) {
    for (uint pixel = 0; pixel < 50; ++pixel) {
        std::set<int> squares;
        std::set<int> columns;
        std::set<int> rows;
        for (uint sample = 0; sample < 16; ++sample) {
            const glm::dvec2 p = reference::pixel_position(pixel, sample, 9);
            ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
            squares.insert(static_cast<int>(p.x * 4) + 4 * static_cast<int>(p.y * 4));
            columns.insert(static_cast<int>(p.x * 16));
            rows.insert(static_cast<int>(p.y * 16));
        }
        EXPECT_EQ(squares.size(), 16u);
        EXPECT_EQ(columns.size(), 16u);
        EXPECT_EQ(rows.size(), 16u);
    }
}

}  // namespace manylight
