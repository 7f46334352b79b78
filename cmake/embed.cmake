# SPDX-License-Identifier: MIT
# Writes OUTPUT, a C++ source that defines manylight::kernel_sources from FILES below ROOT.
set(arrays "")
set(table "")
set(index 0)
foreach(file IN LISTS FILES)
    file(READ ${ROOT}/${file} hex HEX)
    string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
    string(APPEND arrays "constexpr unsigned char source_${index}[] = {${bytes}0};\n")
    string(APPEND table "    {\"${file}\", reinterpret_cast<const char*>(source_${index})},\n")
    math(EXPR index "${index} + 1")
endforeach()
file(WRITE ${OUTPUT} "#include \"device/kernel_sources.hpp\"

namespace {
${arrays}}  // namespace

const std::map<std::string_view, std::string_view> manylight::kernel_sources = {
${table}};
")
