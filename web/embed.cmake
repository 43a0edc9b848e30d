# cmake -DLIST=… -DOUTPUT=… -DHEADER=… -DTYPE=… -DFUNCTION=… -P embed.cmake: writes the files of LIST (lines of
# path=file) as a C++ source that defines FUNCTION, of TYPEs {path, type, body}, which HEADER declares. String literals
# of hexadecimal escapes hold any byte and compile fastest.

set(type_html "text/html; charset=utf-8")
set(type_js "text/javascript; charset=utf-8")
set(type_json "application/json")
set(type_mjs "${type_js}")
set(type_css "text/css; charset=utf-8")
set(type_txt "text/plain; charset=utf-8")
set(type_svg "image/svg+xml")
set(type_png "image/png")
set(type_ico "image/x-icon")
set(type_webmanifest "application/manifest+json")
set(type_woff2 "font/woff2")

file(STRINGS "${LIST}" lines ENCODING UTF-8)
set(entries "")
foreach(line IN LISTS lines)
  string(REGEX MATCH "^([^=]*)=(.*)$" _ "${line}")
  set(path "${CMAKE_MATCH_1}")
  set(file "${CMAKE_MATCH_2}")
  if(NOT EXISTS "${file}")
    if(file MATCHES "/node_modules/")
      message(FATAL_ERROR "The plot library is missing (${file}). Mend: run `npm ci --ignore-scripts` in web/, "
                          "or let `./dev build` do it.")
    endif()
    message(FATAL_ERROR "${file} is missing.")
  endif()
  file(READ "${file}" bytes HEX)
  file(SIZE "${file}" size)
  # 32 bytes a line
  string(REPEAT "[0-9a-f]" 64 row)
  string(REGEX REPLACE "(${row})" "\\1\"\n    \"" bytes "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" bytes "${bytes}")
  string(REGEX MATCH "[a-z0-9]+$" extension "${path}")
  string(APPEND entries "    {\"${path}\", \"${type_${extension}}\", std::string_view(\n    \"${bytes}\", ${size})},\n")
endforeach()

file(WRITE "${OUTPUT}" "// Made by web/embed.cmake.
#include \"${HEADER}\"

#include <span>
#include <string_view>

namespace least::server {

std::span<const ${TYPE}> ${FUNCTION}() {
  static constexpr ${TYPE} all[] = {
${entries}  };
  return all;
}

}  // namespace least::server
")
