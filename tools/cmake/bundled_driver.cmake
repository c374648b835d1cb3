# A Vulkan driver that SimVis brings along, for machines without one: tools/build_driver makes it, and wheels have it.
# It lies with a description for the Vulkan loader in the folder `simvis` beside the library.
set(SIMVIS_DRIVER "" CACHE FILEPATH "Vulkan driver to bring along, that of tools/build_driver; empty: none")
set(folder ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/${SIMVIS_IMPORT_FOLDER})
set(driver ${folder}/libvulkan_lvp.so)
set(description ${folder}/bundled_driver.json)
if(NOT SIMVIS_DRIVER)
  file(REMOVE ${driver} ${description})
  return()
endif()
file(MAKE_DIRECTORY ${folder})
file(COPY_FILE ${SIMVIS_DRIVER} ${driver} ONLY_IF_DIFFERENT)
file(WRITE ${description} [[
{"file_format_version": "1.0.0", "ICD": {"library_path": "./libvulkan_lvp.so", "api_version": "1.3.230"}}
]])
install(FILES ${driver} ${description} DESTINATION ${CMAKE_INSTALL_LIBDIR}/${SIMVIS_IMPORT_FOLDER})
