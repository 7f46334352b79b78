// SPDX-License-Identifier: MIT
#include "output/progress.hpp"

#include <gtest/gtest.h>

namespace manylight {

// Tests' standard error is captured in a file, as a log is.
TEST(progress, a_log_gets_lines) {
    testing::internal::CaptureStderr();
    {
        Progress progress("rendering", false, std::chrono::milliseconds(0));
        progress.set(0.25);
        progress.part(0.5, 1);
        progress.set(0.5);
    }
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_EQ(text, "rendering  25%, 0 s left\nrendering  75%, 0 s left\n");
}

TEST(progress, nothing_is_shown_before_its_time_or_in_quiet) {
    testing::internal::CaptureStderr();
    {
        Progress soon("rendering");
        soon.set(0.5);
        Progress quiet("rendering", true, std::chrono::milliseconds(0));
        quiet.set(0.5);
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace manylight
