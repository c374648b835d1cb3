# The engine of rigid bodies: a module beside the import programs, which the library loads when a scene has physics, so that
# no other program gets Bullet. Of SimVis it includes elements/dynamics/world/world.h and engine/base/state_archive.h.
find_library(SIMVIS_HACD HACD-float64)  # of Bullet's extras
if(NOT bullet_FOUND OR NOT SIMVIS_HACD)
  return()
endif()
file(GLOB dynamics_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/elements/dynamics/bullet/*.cpp)
list(APPEND dynamics_sources ${PROJECT_SOURCE_DIR}/elements/dynamics/world/mass.cpp
     ${PROJECT_SOURCE_DIR}/engine/base/state_archive.cpp)
add_library(simvis-dynamics MODULE ${dynamics_sources})
simvis_unity(simvis-dynamics "${dynamics_sources}")
target_include_directories(simvis-dynamics PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include)
target_link_libraries(simvis-dynamics PRIVATE PkgConfig::bullet ${SIMVIS_HACD} meshoptimizer::meshoptimizer glm::glm)
target_link_options(simvis-dynamics PRIVATE LINKER:--as-needed)
set_target_properties(simvis-dynamics PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                      LIBRARY_OUTPUT_DIRECTORY ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/${SIMVIS_IMPORT_FOLDER})
install(TARGETS simvis-dynamics LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/${SIMVIS_IMPORT_FOLDER})
add_dependencies(simvis simvis-dynamics)
