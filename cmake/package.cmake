# `cpack` makes a Debian package of what is installed. dpkg-shlibdeps finds the libraries that the programs link; Python modules and
# programs that they start are those of packages.txt.
file(STRINGS ${PROJECT_SOURCE_DIR}/packages.txt packages REGEX "^[^#]")
set(started ${packages})
list(FILTER started INCLUDE REGEX "^(python3.*|openmpi-bin|libopenblas.*)$")
list(JOIN started ", " CPACK_DEBIAN_PACKAGE_DEPENDS)
# what find_package(Talus) needs
set(for_hosts ${packages})
list(FILTER for_hosts INCLUDE REGEX "^(g[+][+]|gfortran|cmake|pkg-config|petsc-dev|nlohmann-json3-dev|lib.*-dev)$")
list(FILTER for_hosts EXCLUDE REGEX "^lib(eigen3|cli11|gmsh|gdal|gtest)-dev$")
list(JOIN for_hosts ", " CPACK_DEBIAN_PACKAGE_RECOMMENDS)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME talus)
set(CPACK_PACKAGE_CONTACT "The Talus developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "Program, and library for host programs (find_package(Talus)).
 Licence: BSD-3-Clause; the program talus-mesh links Gmsh (GPL).")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
include(CPack)
