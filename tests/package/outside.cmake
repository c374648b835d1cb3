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
# A failing test leaves a page and a recording with the types of its own program, without simvis-run in the PATH.
file(WRITE ${FOLDER}/own.xml "<simvis><element type='own_gripper' name='GRIPPER' insert_at='ROOT'/>"
     "<sensor type='own_battery' name='BATTERY' insert_at='ROOT'/></simvis>")
run(${CMAKE_COMMAND} -E env PATH=/nowhere ${build}/failing_run ${FOLDER}/own.xml ${FOLDER}/evidence)
message("${output}")
set(evidence ${FOLDER}/evidence/outside)
string(REGEX REPLACE "([][+.*()^])" "\\\\\\1" expected "${evidence}")
if(NOT output MATCHES "^at [0-9.]+ s: the charge is 0.4[0-9]+\npage:      file://${expected}/failure.html#frame=[0-9]+\nrecording: ${expected}/failure.mcap\n$")
  message(FATAL_ERROR "a failing test says \"${output}\", expected its page and its recording in ${evidence}")
endif()
file(STRINGS ${evidence}/failure.mcap recorded REGEX "BATTERY" LIMIT_COUNT 1)
file(STRINGS ${evidence}/failure.html frames REGEX "id=.frame-0." LIMIT_COUNT 1)
if(NOT recorded OR NOT frames)
  message(FATAL_ERROR "the recording or the page in ${evidence} lacks what was measured")
endif()
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
