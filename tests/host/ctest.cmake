# Installs Talus under the build folder, builds the host program against that alone, and runs it.
set(host_prefix ${CMAKE_BINARY_DIR}/host/prefix)
set(host_build ${CMAKE_BINARY_DIR}/host/build)
add_test(NAME host_install COMMAND ${CMAKE_COMMAND} --install ${CMAKE_BINARY_DIR} --prefix ${host_prefix})
add_test(NAME host_build
  COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${CMAKE_CURRENT_LIST_DIR} ${host_build} --build-generator Ninja
          --build-options -DCMAKE_PREFIX_PATH=${host_prefix} -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE})
set_tests_properties(host_install PROPERTIES LABELS exactness FIXTURES_SETUP host_prefix)
set_tests_properties(host_build PROPERTIES LABELS exactness FIXTURES_REQUIRED host_prefix FIXTURES_SETUP host_program)
foreach(ranks 1 2)
  add_test(NAME host_on_${ranks}_ranks
    COMMAND ${MPIEXEC_EXECUTABLE} --allow-run-as-root --oversubscribe -n ${ranks} ${host_build}/host)
  set_tests_properties(host_on_${ranks}_ranks PROPERTIES
    LABELS exactness FIXTURES_REQUIRED host_program PROCESSORS ${ranks} TIMEOUT 120)
endforeach()
