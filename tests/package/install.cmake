# Installs SimVis for the tests of the package, and looks at what is installed.
# Needs BINARY_DIR (of SimVis), PREFIX (where to install it), FOLDER (for results) and VERSION.
include(${CMAKE_CURRENT_LIST_DIR}/installed.cmake)
file(REMOVE_RECURSE ${PREFIX} ${FOLDER})
run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${PREFIX})

# The installed program finds the installed library beside it, and that the installed import programs: with them gone, it
# says which one is missing.
run(${PREFIX}/bin/simvis-run --version)
if(NOT output MATCHES "${VERSION}")
  message(FATAL_ERROR "the installed simvis-run says \"${output}\", expected version ${VERSION}")
endif()
set(scene ${FOLDER}/scene.xml)
file(WRITE ${FOLDER}/wall.obj "v 3 -1 -1\nv 3 1 -1\nv 3 0 1\nf 1 2 3\n")
file(WRITE ${scene} "<simvis><part file='wall.obj' name='WALL' insert_at='ROOT'/>"
     "<sensor type='laser_scanner' name='SCANNER' insert_at='ROOT' samples='3' min_angle='-5' max_angle='5'/></simvis>")
set(command ${PREFIX}/bin/simvis-run --quiet --out ${FOLDER}/out ${scene})
run(${command})
file(GLOB_RECURSE program ${PREFIX}/*/simvis-import-mesh)
file(RENAME ${program} ${program}-gone)
execute_process(COMMAND ${command} RESULT_VARIABLE status ERROR_VARIABLE output)
file(RENAME ${program}-gone ${program})
if(status EQUAL 0 OR NOT output MATCHES "simvis-import-mesh, the helper program that reads part files: No such file or directory")
  message(FATAL_ERROR "without simvis-import-mesh, simvis-run ends with ${status} and says \"${output}\"")
endif()
