# Installs the package beside the build, builds the consumer against it and runs it.
# Takes SOURCE_DIR, LODESTONE_BINARY_DIR, WORK_DIR, GENERATOR, CXX_COMPILER.

function(run_step)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "failed with ${result}: ${ARGN}")
  endif()
endfunction()

# From nothing: an old install must not stand in for a file that is no longer installed.
file(REMOVE_RECURSE ${WORK_DIR})
run_step(${CMAKE_COMMAND} --install ${LODESTONE_BINARY_DIR} --prefix ${WORK_DIR}/prefix)
run_step(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/build -G ${GENERATOR}
         -D CMAKE_CXX_COMPILER=${CXX_COMPILER} -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
run_step(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run_step(${WORK_DIR}/build/consumer ${WORK_DIR}/level.obj)
run_step(${WORK_DIR}/build/build ${SOURCE_DIR}/../../demo/suzi.glb ${WORK_DIR}/suzi.glb)
run_step(${WORK_DIR}/build/draw ${SOURCE_DIR}/../golden/stream-1.0.lds)
run_step(${WORK_DIR}/build/model)
run_step(${WORK_DIR}/build/model_with_own_tinygltf)
