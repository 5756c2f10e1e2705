# Installs the headers of a host program, without templates of the kernel and without Eigen. Includes that count from src/ become
# <talus/...>, so that a host's include path gains no `base` and no `scene`.
set(root ${CMAKE_CURRENT_LIST_DIR}/..)
foreach(header talus.h simulation.h output/events.h output/results.h base/boxed.h scene/scene.h scene/deferred.h scene/phase_model.h meshes/mesh_report.h physics/laws/strength_range.h solvers/quasi_static/factor_of_safety.h)
  set(file ${root}/src/${header})
  if(NOT EXISTS ${file})
    set(file ${root}/${header})
  endif()
  file(READ ${file} text)
  string(REGEX REPLACE "#include \"([^\"\n]+)\"" "#include <talus/\\1>" text "${text}")
  file(CONFIGURE OUTPUT ${talus_headers_to}/${header} CONTENT "${text}" @ONLY)
  list(APPEND CMAKE_INSTALL_MANIFEST_FILES ${talus_headers_to}/${header})
endforeach()
