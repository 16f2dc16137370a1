# One way to define a module: its own include root, its alias, the project's warnings and sanitizers.

function(lodestone_settings target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
  # Results are the same bytes everywhere: no fused multiply-add behind the source's back. Nobody looks at errno or the
  # exception flags of arithmetic, and loops vectorise only without them.
  target_compile_options(${target} PRIVATE -ffp-contract=off -fno-math-errno -fno-trapping-math)
  if(EMSCRIPTEN)  # lengths have 32 bits there, and what is longer cannot have arrived
    target_compile_options(${target} PRIVATE -Wno-shorten-64-to-32)
  endif()
  if(LODESTONE_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-sanitize-recover=all
                                             -fno-omit-frame-pointer -D_GLIBCXX_ASSERTIONS
                                             $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    # To clang a sanitized vector's operator[] is too large to be inlined, and at -O1 everything is: with it inlined, tests take half.
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,Clang>:-finline-functions>
                                             "$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-mllvm -inline-threshold=600>")
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
endfunction()

# Where CMAKE_UNITY_BUILD is on, which the sanitized preset has: so many sources of a folder are compiled at once. Headers and
# what they instantiate, JSON above all, cost more than most sources.
set(LODESTONE_BATCH 8)
function(lodestone_compile_in_batches target)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_filename_component(folder ${source} DIRECTORY)
    get_filename_component(folder "${folder}" NAME)
    math(EXPR batch "0${count_${folder}} / ${LODESTONE_BATCH}")
    math(EXPR count_${folder} "0${count_${folder}} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP "${folder}_${batch}")
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
endfunction()

# lodestone_module(core SOURCES src/a.cpp … DEPENDS lodestone::… PRIVATE_DEPENDS …): a library of its own, shared where
# BUILD_SHARED_LIBS says so, or always with SHARED. Its public headers lie in include/ of the folder, those for the folder alone are named from it:
# "distance/triangle.h".
function(lodestone_module name)
  cmake_parse_arguments(ARG "SHARED" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  set(target lodestone_${name})
  set(kind)
  if(ARG_SHARED AND NOT EMSCRIPTEN)  # there is one module in the end, and no other to share with
    set(kind SHARED)
  endif()
  add_library(${target} ${kind} ${ARG_SOURCES})
  add_library(lodestone::${name} ALIAS ${target})
  # Before 1.0, a minor version may change the interface, and so the name of the shared library. Those installed find each
  # other wherever they lie.
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON INSTALL_RPATH "$ORIGIN"
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(${target} PUBLIC ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE_DEPENDS})
  lodestone_settings(${target})
  lodestone_compile_in_batches(${target})
  set_property(GLOBAL APPEND PROPERTY LODESTONE_MODULES ${target})
endfunction()

# lodestone_group(lod lodestone::a lodestone::b …): several modules under one name.
function(lodestone_group name)
  set(target lodestone_${name})
  add_library(${target} INTERFACE)
  add_library(lodestone::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_link_libraries(${target} INTERFACE ${ARGN})
  set_property(GLOBAL APPEND PROPERTY LODESTONE_MODULES ${target})
endfunction()
