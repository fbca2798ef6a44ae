# Installs BUILD into WORK, builds the consumer against it, and lets it animate SPEECH with a model that is missing: it
# must link, start and name the model.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGV}\n${out}")
  endif()
endfunction()
file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK}/build -G ${GENERATOR}
    -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${WORK}/build)
execute_process(COMMAND ${WORK}/build/consumer ${SPEECH} ${WORK}/absent.safetensors ${WORK}/out.csv
                RESULT_VARIABLE code ERROR_VARIABLE err)
if(NOT code EQUAL 1 OR NOT err MATCHES "absent.safetensors.*file not found")
  message(FATAL_ERROR "consumer: exit code ${code}, message: ${err}")
endif()
# The installed program finds what was installed with it.
run(${WORK}/prefix/bin/mien --version)
if(EXISTS ${WORK}/prefix/share/mien/default.safetensors)
  run(${WORK}/build/consumer ${SPEECH} ${WORK}/prefix/share/mien/default.safetensors ${WORK}/out.csv)
  run(${WORK}/prefix/bin/mien animate ${SPEECH} --seed 7 -o ${WORK}/program.csv)
  run(${CMAKE_COMMAND} -E compare_files ${WORK}/out.csv ${WORK}/program.csv)
endif()
file(REMOVE_RECURSE ${WORK}/prefix)
