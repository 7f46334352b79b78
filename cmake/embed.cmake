# SPDX-License-Identifier: MIT
# Writes OUTPUT, a C++ source that defines manylight::VARIABLE, which HEADER declares, from files at
# PATHS by their NAMES.
set(arrays "")
set(table "")
set(index 0)
foreach(name path IN ZIP_LISTS NAMES PATHS)
    file(READ ${path} hex HEX)
    string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
    string(APPEND arrays "constexpr unsigned char source_${index}[] = {${bytes}0};\n")
    string(APPEND table "    {\"${name}\", reinterpret_cast<const char*>(source_${index})},\n")
    math(EXPR index "${index} + 1")
endforeach()
file(WRITE ${OUTPUT} "#include \"${HEADER}\"

namespace {
${arrays}}  // namespace

const std::map<std::string_view, std::string_view> manylight::${VARIABLE} = {
${table}};
")
