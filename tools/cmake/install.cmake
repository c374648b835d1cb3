# What `cmake --install` puts where, and what makes find_package(simvis) work.
include(CMakePackageConfigHelpers)

install(TARGETS simvis simvis-testing EXPORT simvisTargets)
install(TARGETS simvis-run)
install(DIRECTORY include/simvis DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
# find_package(simvis COMPONENTS client): what other processes need, without the simulator.
install(TARGETS simvis_client EXPORT simvisClientTargets)
install(TARGETS simvis-ctl)
install(DIRECTORY include/simvis_client DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES exchange/clients/simvis_client.py DESTINATION ${CMAKE_INSTALL_DATADIR}/simvis/python)
install(DIRECTORY exchange/clients/examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES exchange/clients/simvis-ctl.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME simvis-ctl)

# The package of ROS 2 that starts simvis-run.
add_subdirectory(program/ros)

# What simvis-run prints about itself, for editors, shells and man.
set(printed_files)
macro(simvis_printed_file folder name)
  set(file ${PROJECT_BINARY_DIR}/printed/${folder}/${name})
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/printed/${folder})
  add_custom_command(OUTPUT ${file} COMMAND simvis-run ${ARGN} > ${file} DEPENDS simvis-run
                     COMMENT "Printing ${name}" VERBATIM)
  install(FILES ${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/${folder})
  list(APPEND printed_files ${file})
endmacro()
simvis_printed_file(simvis simvis.xsd --describe all --xsd)
simvis_printed_file(man/man1 simvis-run.1 --man)
simvis_printed_file(bash-completion/completions simvis-run --completion bash)
simvis_printed_file(zsh/site-functions _simvis-run --completion zsh)
simvis_printed_file(fish/vendor_completions.d simvis-run.fish --completion fish)
add_custom_target(simvis_printed_files ALL DEPENDS ${printed_files})

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/simvis)
install(EXPORT simvisTargets NAMESPACE simvis:: DESTINATION ${package_folder})
install(EXPORT simvisClientTargets NAMESPACE simvis:: DESTINATION ${package_folder})
configure_package_config_file(tools/cmake/simvisConfig.cmake.in ${PROJECT_BINARY_DIR}/simvisConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
# Before 1.0 a new minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/simvisConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/simvisConfig.cmake ${PROJECT_BINARY_DIR}/simvisConfigVersion.cmake
        DESTINATION ${package_folder})
