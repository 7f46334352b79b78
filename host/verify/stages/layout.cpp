// SPDX-License-Identifier: MIT
// Stage layout: where fields of shared structs are.
#include <cstddef>

#include "shared/layout.h"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

Check layout(Verifier& verifier) {
    Check check{.stage = "layout", .tolerance = exact};
    std::vector<uint> expected;
    std::vector<std::string> names;
#define EXPECT_FIELD(type, field)              \
    expected.push_back(offsetof(type, field)); \
    names.push_back(#type "." #field);
    SHARED_FIELDS(EXPECT_FIELD)
#undef EXPECT_FIELD
    Buffer<uint> offsets = verifier.device().allocate<uint>(expected.size());
    verifier.device()
        .kernel("probe.cl", "probe_layout", {}, "probe")
        .launch(1, Arguments().set("offsets", offsets));
    const std::vector<uint> found = offsets.download();
    for (std::size_t i = 0; i < expected.size(); ++i)
        check.compare_exact(found[i] == expected[i], fmt::format("{} is at byte {}, not {}",
                                                                 names[i], found[i], expected[i]));
    return check;
}

}  // namespace

StageCheck check_layout() { return {.stages = {"layout"}, .run = single<layout>}; }

}  // namespace manylight
