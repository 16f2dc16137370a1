# Writes a C++ header with the text of files: cmake -D OUTPUT=… -D NAMESPACE=… -D "FILES=kName=path|kOther=path" -P EmbedText.cmake

string(REPLACE "|" ";" FILES "${FILES}")
set(header "#pragma once\n\n#include <string_view>\n\nnamespace ${NAMESPACE} {\n\n")
foreach(entry IN LISTS FILES)
  string(REGEX MATCH "^([^=]+)=(.+)$" matched "${entry}")
  set(name "${CMAKE_MATCH_1}")
  file(READ "${CMAKE_MATCH_2}" text)
  string(APPEND header "inline constexpr std::string_view ${name} = R\"embed(${text})embed\";\n\n")
endforeach()
string(APPEND header "}  // namespace ${NAMESPACE}\n")
file(WRITE "${OUTPUT}" "${header}")
