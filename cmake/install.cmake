# What `cmake --install` puts where: the program, the library for C++ with its headers, what CMake and
# pkg-config need to find them, manual pages and shell completions. The modules that are opened on
# demand lie in lib/pse, where program and library look for them.
add_library(pse_shared SHARED ${CMAKE_SOURCE_DIR}/cmake/empty.cpp)
target_link_libraries(pse_shared PRIVATE
  "-Wl,--whole-archive,$<TARGET_FILE:pse_api>,$<TARGET_FILE:pse_noise>,--no-whole-archive" pse_api pse_noise)
target_include_directories(pse_shared INTERFACE $<INSTALL_INTERFACE:include>)
target_compile_features(pse_shared INTERFACE cxx_std_23)
# Only what include/pse declares is to be seen.
target_link_options(pse_shared PRIVATE -Wl,--version-script=${CMAKE_SOURCE_DIR}/cmake/exports.map)
set_target_properties(pse_shared PROPERTIES OUTPUT_NAME pse EXPORT_NAME pse VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR} LINK_DEPENDS ${CMAKE_SOURCE_DIR}/cmake/exports.map)

install(TARGETS pse RUNTIME DESTINATION bin)
install(TARGETS pse_shared EXPORT pse LIBRARY DESTINATION lib)
foreach(module pse_llvm pse_oiio pse_ocio pse_vdb)
  if(TARGET ${module})
    install(TARGETS ${module} LIBRARY DESTINATION lib/pse)
  endif()
endforeach()
install(DIRECTORY include/pse DESTINATION include)

# find_package(pse)
include(CMakePackageConfigHelpers)
install(EXPORT pse NAMESPACE pse:: FILE pseConfig.cmake DESTINATION lib/cmake/pse)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/pseConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/pseConfigVersion.cmake DESTINATION lib/cmake/pse)

# pkg-config
configure_file(${CMAKE_SOURCE_DIR}/cmake/pse.pc.in ${CMAKE_BINARY_DIR}/pse.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/pse.pc DESTINATION lib/pkgconfig)

# Manual pages and completions come from the program itself.
install(CODE "
  set(pse $<TARGET_FILE:pse>)
  set(out \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share\")
  file(MAKE_DIRECTORY \"\${out}/man/man1\" \"\${out}/bash-completion/completions\"
       \"\${out}/zsh/site-functions\" \"\${out}/fish/vendor_completions.d\")
  foreach(command render trace bake check fmt info doc diff completion)
    execute_process(COMMAND \${pse} help --man \${command} COMMAND_ERROR_IS_FATAL ANY
                    OUTPUT_FILE \"\${out}/man/man1/pse-\${command}.1\")
  endforeach()
  execute_process(COMMAND \${pse} help --man COMMAND_ERROR_IS_FATAL ANY OUTPUT_FILE \"\${out}/man/man1/pse.1\")
  execute_process(COMMAND \${pse} completion bash OUTPUT_FILE \"\${out}/bash-completion/completions/pse\")
  execute_process(COMMAND \${pse} completion zsh OUTPUT_FILE \"\${out}/zsh/site-functions/_pse\")
  execute_process(COMMAND \${pse} completion fish OUTPUT_FILE \"\${out}/fish/vendor_completions.d/pse.fish\")
")
