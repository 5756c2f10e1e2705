# cmake -DTALUS=program -DPAGE=docs/reference/scene.md [-DCHECK=ON] -P reference_page.cmake: writes the page of all scene keys as the
# program prints them, or checks that the page is in step with the program.
execute_process(COMMAND ${TALUS} describe OUTPUT_VARIABLE keys COMMAND_ERROR_IS_FATAL ANY)
string(CONCAT page
  "# Keys of a scene\n\n"
  "Printed by the program: `./talus describe` shows this page, `./talus describe KEY` a part of it. After a change of keys\n"
  "`cmake --build build/release --target reference` writes it again.\n\n"
  "${keys}")
if(NOT CHECK)
  file(WRITE ${PAGE} "${page}")
  return()
endif()
file(READ ${PAGE} committed)
if(NOT committed STREQUAL page)
  message(FATAL_ERROR "${PAGE} is not what the program prints; build the target `reference`")
endif()
