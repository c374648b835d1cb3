# Installs SimVis, then configures, builds and runs a project outside of it that finds the installed package.
# Needs BINARY_DIR (of SimVis), SOURCE_DIR (of this folder), FOLDER (where to install and build), COMPILER and VERSION.
set(prefix ${FOLDER}/prefix)
set(build ${FOLDER}/build)
file(REMOVE_RECURSE ${FOLDER})

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
    -DCMAKE_CXX_COMPILER=${COMPILER} -DPLUGIN_FOLDER=${SOURCE_DIR}/../plugin)
run(${CMAKE_COMMAND} --build ${build})
run(${build}/outside)
message("${output}")
# A client is a project of its own: COMPONENTS client.
run(${CMAKE_COMMAND} -G Ninja -S ${SOURCE_DIR}/outside_client -B ${build}_client -DCMAKE_PREFIX_PATH=${prefix})
run(${CMAKE_COMMAND} --build ${build}_client)
run(${build}_client/outside_client)
# The installed program finds the installed library beside it, and that the installed import programs: with them gone, it
# says which one is missing.
run(${prefix}/bin/simvis-run --version)
if(NOT output MATCHES "${VERSION}")
  message(FATAL_ERROR "the installed simvis-run says \"${output}\", expected version ${VERSION}")
endif()
set(scene ${FOLDER}/scene.xml)
file(WRITE ${FOLDER}/wall.obj "v 3 -1 -1\nv 3 1 -1\nv 3 0 1\nf 1 2 3\n")
file(WRITE ${scene} "<simvis><part file='wall.obj' name='WALL' insert_at='ROOT'/>"
     "<sensor type='laser_scanner' name='SCANNER' insert_at='ROOT' samples='3' min_angle='-5' max_angle='5'/></simvis>")
set(command ${prefix}/bin/simvis-run --quiet --out ${FOLDER}/out ${scene})
run(${command})
# It loads the plug-in.
file(WRITE ${FOLDER}/plugin.xml "<simvis><element type='plate' name='PLATE' insert_at='ROOT' x='2.5'/>"
     "<sensor type='distance_probe' name='PROBE' insert_at='ROOT'/></simvis>")
run(${prefix}/bin/simvis-run --quiet --plugin ${build}/libplugin.so --out ${FOLDER}/plugin_out ${FOLDER}/plugin.xml)
file(READ ${FOLDER}/plugin_out/PROBE.csv distances)
if(NOT distances MATCHES ",2\\.(5|49999[0-9]*|50000[0-9]*)\n")
  message(FATAL_ERROR "the plug-in's probe sees \"${distances}\", expected a plate at 2.5 m")
endif()
file(GLOB_RECURSE program ${prefix}/*/simvis-import-mesh)
file(RENAME ${program} ${program}-gone)
execute_process(COMMAND ${command} RESULT_VARIABLE status ERROR_VARIABLE output)
if(status EQUAL 0 OR NOT output MATCHES "simvis-import-mesh, the helper program that reads part files: No such file or directory")
  message(FATAL_ERROR "without simvis-import-mesh, simvis-run ends with ${status} and says \"${output}\"")
endif()
