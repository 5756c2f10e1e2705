# What `cmake --install` puts in place: the programs, and the component for host programs (find_package(Talus)) as one library.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# How a host finds again what the rooms link; TalusConfig.cmake looks for the same. Eigen stays inside: its alignment depends on -march.
set(known_outside MPI::MPI_CXX PkgConfig::PETSC PkgConfig::LAPACK PkgConfig::HDF5 PkgConfig::MUPARSER tomlplusplus::tomlplusplus nlohmann_json::nlohmann_json SUNDIALS::arkode SUNDIALS::nvecpetsc)

# The static libraries that `target` stands on, itself included, and what they link from outside.
function(collect_rooms target rooms outside)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    list(APPEND ${rooms} ${target})
    get_target_property(links ${target} LINK_LIBRARIES)
  else()
    get_target_property(links ${target} INTERFACE_LINK_LIBRARIES)
  endif()
  foreach(link IN LISTS links)
    if(link MATCHES "^talus_" AND NOT link IN_LIST ${rooms})
      collect_rooms(${link} ${rooms} ${outside})
    elseif(link MATCHES "::" AND NOT link STREQUAL "Eigen3::Eigen")
      list(APPEND ${outside} ${link})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES ${rooms})
  list(REMOVE_DUPLICATES ${outside})
  set(${rooms} ${${rooms}} PARENT_SCOPE)
  set(${outside} ${${outside}} PARENT_SCOPE)
endfunction()

collect_rooms(talus_simulation component_rooms component_links)
foreach(link IN LISTS component_links)
  if(NOT link IN_LIST known_outside)
    message(FATAL_ERROR "a room links ${link}: add it to cmake/install.cmake and cmake/TalusConfig.cmake.in, so that hosts find it")
  endif()
endforeach()

add_library(talus_component STATIC)
foreach(room IN LISTS component_rooms)
  target_sources(talus_component PRIVATE $<TARGET_OBJECTS:${room}>)
endforeach()
set_target_properties(talus_component PROPERTIES OUTPUT_NAME talus EXPORT_NAME talus LINKER_LANGUAGE CXX)
target_compile_features(talus_component INTERFACE cxx_std_20)
target_include_directories(talus_component INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(talus_component INTERFACE ${component_links})
target_link_options(talus_component INTERFACE $<$<BOOL:${TALUS_SANITIZE}>:-fsanitize=address,undefined>)
add_dependencies(talus talus_component)  # so that what `./talus run` has built can be installed

install(TARGETS talus talus-mesh)
install(TARGETS talus_component EXPORT talus)
install(EXPORT talus NAMESPACE Talus:: FILE TalusTargets.cmake DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Talus)
configure_package_config_file(cmake/TalusConfig.cmake.in TalusConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Talus)
write_basic_package_version_file(TalusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/TalusConfig.cmake ${PROJECT_BINARY_DIR}/TalusConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Talus)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
# scenes name their sections by relative paths: the layout of the source tree stays
install(DIRECTORY docs/gallery DESTINATION ${CMAKE_INSTALL_DATADIR}/talus/docs FILES_MATCHING PATTERN "*.toml" PATTERN "*.csv" PATTERN "*.md")
install(DIRECTORY tests/verification tests/convergence tests/validation DESTINATION ${CMAKE_INSTALL_DATADIR}/talus/tests
  FILES_MATCHING PATTERN "*.toml" PATTERN "*.csv" PATTERN "*.msh")
install(DIRECTORY meshes DESTINATION ${CMAKE_INSTALL_DATADIR}/talus FILES_MATCHING PATTERN "*.csv")
install(CODE "set(talus_headers_to \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/talus\")")
install(SCRIPT cmake/install_headers.cmake)
