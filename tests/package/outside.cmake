# Configures, builds and runs a project outside of SimVis that finds the installed package, and loads its plug-in.
# Needs PREFIX (where SimVis is installed), FOLDER (where to build), COMPILER and EACH_HEADER (see outside/).
include(${CMAKE_CURRENT_LIST_DIR}/installed.cmake)
set(build ${FOLDER}/build)
file(REMOVE_RECURSE ${FOLDER})
run(${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR}/outside -B ${build} -DCMAKE_PREFIX_PATH=${PREFIX}
    -DCMAKE_CXX_COMPILER=${COMPILER} -DEACH_HEADER=${EACH_HEADER} -DPLUGIN_FOLDER=${CMAKE_CURRENT_LIST_DIR}/../plugin)
run(${CMAKE_COMMAND} --build ${build})
run(${build}/outside)
message("${output}")
# A client is a project of its own: COMPONENTS client.
run(${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR}/outside_client -B ${build}_client
    -DCMAKE_PREFIX_PATH=${PREFIX})
run(${CMAKE_COMMAND} --build ${build}_client)
run(${build}_client/outside_client)
file(WRITE ${FOLDER}/plugin.xml "<simvis><element type='plate' name='PLATE' insert_at='ROOT' x='2.5'/>"
     "<sensor type='distance_probe' name='PROBE' insert_at='ROOT'/></simvis>")
run(${PREFIX}/bin/simvis-run --quiet --plugin ${build}/libplugin.so --out ${FOLDER}/plugin_out ${FOLDER}/plugin.xml)
file(READ ${FOLDER}/plugin_out/PROBE.csv distances)
if(NOT distances MATCHES ",2\\.(5|49999[0-9]*|50000[0-9]*)\n")
  message(FATAL_ERROR "the plug-in's probe sees \"${distances}\", expected a plate at 2.5 m")
endif()
