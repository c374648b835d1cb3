# Installs SimVis, then configures, builds and runs a project outside of it that finds the installed package.
# Needs BINARY_DIR (of SimVis), SOURCE_DIR (of this folder), COMPILER, FLAGS (for the outside
# project) and VERSION.
set(prefix ${BINARY_DIR}/package_test/prefix)
set(build ${BINARY_DIR}/package_test/build)
file(REMOVE_RECURSE ${BINARY_DIR}/package_test)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}: ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${prefix})
run(${CMAKE_COMMAND} -G Ninja -S ${SOURCE_DIR}/outside -B ${build} -DCMAKE_PREFIX_PATH=${prefix}
    -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${build})
run(${build}/outside)
message("${output}")
# The installed program finds the installed library beside it.
run(${prefix}/bin/simvis-run --version)
if(NOT output MATCHES "${VERSION}")
  message(FATAL_ERROR "the installed simvis-run says \"${output}\", expected version ${VERSION}")
endif()
