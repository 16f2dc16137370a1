# What the scripts beside this one do alike. They take SOURCE_DIR (of the programs), LODESTONE_SOURCE, WORK_DIR, GENERATOR,
# CXX_COMPILER, C_COMPILER.

function(run_step)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "failed with ${result}: ${ARGN}")
  endif()
endfunction()

# build_programs(FOLDER OPTION …): configures the programs in a folder of WORK_DIR, and builds them.
function(build_programs folder)
  run_step(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/${folder} -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${CXX_COMPILER}
           -D CMAKE_C_COMPILER=${C_COMPILER} ${ARGN})
  run_step(${CMAKE_COMMAND} --build ${WORK_DIR}/${folder})
endfunction()

function(run_draw folder)
  foreach(program draw draw_c)
    run_step(${WORK_DIR}/${folder}/${program} ${LODESTONE_SOURCE}/tests/golden/stream-1.0.lds)
  endforeach()
endfunction()

# run_programs(FOLDER MODEL): MODEL is what to build from; level.obj is a small one that the first program leaves.
function(run_programs folder model)
  run_draw(${folder})
  run_step(${WORK_DIR}/${folder}/consumer ${WORK_DIR}/level.obj)
  run_step(${WORK_DIR}/${folder}/build ${model} ${WORK_DIR}/built.glb)
  run_step(${WORK_DIR}/${folder}/model)
  run_step(${WORK_DIR}/${folder}/model_with_own_tinygltf)
endfunction()

# Builds three programs with what pkg-config says of the package installed in WORK_DIR/prefix, and runs them after run_programs.
function(run_with_pkg_config)
  find_program(PKG_CONFIG NAMES pkg-config pkgconf)
  if(NOT PKG_CONFIG)
    message(STATUS "SKIPPED: no pkg-config")
    return()
  endif()
  file(GLOB_RECURSE package ${WORK_DIR}/prefix/*/lodestone.pc)
  cmake_path(GET package PARENT_PATH packages)
  cmake_path(GET packages PARENT_PATH libraries)
  file(MAKE_DIRECTORY ${WORK_DIR}/pkg-config)
  foreach(program draw.cpp=lodestone-stream build.cpp=lodestone draw.c=lodestone-c)
    string(REPLACE "=" ";" program ${program})
    list(POP_FRONT program source)
    string(REGEX REPLACE "\\.c$" "_c" name ${source})
    string(REGEX REPLACE "\\.cpp$" "" name ${name})
    set(compile ${CXX_COMPILER} -std=c++20)
    if(source MATCHES "\\.c$")
      set(compile ${C_COMPILER} -std=c11)
    endif()
    execute_process(COMMAND ${CMAKE_COMMAND} -E env --modify PKG_CONFIG_PATH=path_list_prepend:${packages}
                            ${PKG_CONFIG} --cflags --libs ${program}
                    OUTPUT_VARIABLE flags RESULT_VARIABLE result OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT result EQUAL 0)
      message(FATAL_ERROR "pkg-config does not know ${program}")
    endif()
    separate_arguments(flags UNIX_COMMAND "${flags}")
    run_step(${compile} ${SANITIZE} ${SOURCE_DIR}/${source} -o ${WORK_DIR}/pkg-config/${name} ${flags}
             -Wl,-rpath,${libraries})
  endforeach()
  run_draw(pkg-config)
  run_step(${WORK_DIR}/pkg-config/build ${WORK_DIR}/level.obj ${WORK_DIR}/built.glb)
endfunction()

# From nothing: an old install must not stand in for a file that is no longer installed.
file(REMOVE_RECURSE ${WORK_DIR})
