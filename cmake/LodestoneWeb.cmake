# For Emscripten, whose headers and libraries are its own: of the machine's, only the two that are headers alone are let in.

set(web_headers ${PROJECT_BINARY_DIR}/headers)
find_path(TL_EXPECTED_INCLUDE_DIR tl/expected.hpp PATHS /usr/local/include /usr/include NO_CMAKE_FIND_ROOT_PATH REQUIRED)
find_path(XXHASH_MACHINE_INCLUDE_DIR xxhash.h PATHS /usr/local/include /usr/include NO_CMAKE_FIND_ROOT_PATH REQUIRED)
configure_file(${TL_EXPECTED_INCLUDE_DIR}/tl/expected.hpp ${web_headers}/tl/expected.hpp COPYONLY)
configure_file(${XXHASH_MACHINE_INCLUDE_DIR}/xxhash.h ${web_headers}/xxhash.h COPYONLY)
set(XXHASH_INCLUDE_DIR ${web_headers} CACHE PATH "Where xxhash.h is" FORCE)
add_library(tl::expected INTERFACE IMPORTED GLOBAL)
target_include_directories(tl::expected INTERFACE ${web_headers})

# Nothing in the runtime throws; and memory that is not there ends the module either way.
add_compile_options(-fno-exceptions)
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fno-rtti>)
