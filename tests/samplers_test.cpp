// SPDX-License-Identifier: MIT
// The table of samplers and their parameters.
#include <gtest/gtest.h>

#include "error.hpp"
#include "samplers/table.hpp"

namespace manylight {
namespace {

Sampler row_with_parameters() {
    Sampler row = find_sampler("uniform");
    row.parameters = {{"tau", 0.05, 0, 1, "a threshold"}, {"reach", 8, 1, 64, "a number", true}};
    return row;
}

// What a call that throws says.
std::string refusal(const ParameterValues& set) {
    try {
        (void)values_of(row_with_parameters(), set);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST(samplers, parameters_have_defaults_and_limits) {
    const Sampler row = row_with_parameters();
    EXPECT_EQ(values_of(row), (ParameterValues{{"tau", 0.05}, {"reach", 8}}));
    EXPECT_EQ(values_of(row, {{"tau", 1}}), (ParameterValues{{"tau", 1}, {"reach", 8}}));
    EXPECT_EQ(text_of(values_of(row)), "reach=8,tau=0.05");
    EXPECT_EQ(refusal({{"tau", 1}, {"reach", 64}}), "");
    EXPECT_EQ(refusal({{"tau", 1.5}}), "--set tau=1.5: it is from 0 to 1");
    EXPECT_EQ(refusal({{"reach", 0}}), "--set reach=0: it is from 1 to 64");
    EXPECT_EQ(refusal({{"reach", 8.5}}), "--set reach=8.5: it is a whole number");
    EXPECT_EQ(refusal({{"Tau", 1}}),
              "--set Tau=1: sampler uniform has no such parameter (it has: tau, reach)");
}

TEST(samplers, rows_are_complete) {
    for (const Sampler& row : all_samplers()) {
        EXPECT_FALSE(row.summary.empty()) << row.name;
        EXPECT_TRUE(row.footprint != nullptr && row.make != nullptr) << row.name;
        for (const Parameter& p : row.parameters) {
            EXPECT_LT(p.least, p.most) << row.name << " " << p.name;
            EXPECT_GE(p.value, p.least) << row.name << " " << p.name;
            EXPECT_LE(p.value, p.most) << row.name << " " << p.name;
            EXPECT_FALSE(p.summary.empty()) << row.name << " " << p.name;
        }
    }
}

}  // namespace manylight
