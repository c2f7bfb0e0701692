# How every target of pse is built: one function for a folder of the library, one for a folder of tests.

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # The cache may keep what was compiled with precompiled headers.
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

# Settings that every target shares. Floating point means what the source says: no contraction, no fast-math.
add_library(pse_settings INTERFACE)
target_include_directories(pse_settings INTERFACE ${CMAKE_SOURCE_DIR}/src ${CMAKE_SOURCE_DIR}/include)
target_compile_options(pse_settings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                       -Werror -ffp-contract=off -fno-math-errno)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ 12 merges the two conversions of a pair of doubles to floats and back, and with them the rounding: at -O2 and at
  # -O3, by SLP vectorisation. tests/house/rounding_test.cpp, docs/decisions/2026-11-28-rounding.md.
  # It reports these where nothing is wrong (designated initialisers; std::variant and std::vector moves).
  target_compile_options(pse_settings INTERFACE -fno-tree-slp-vectorize -Wno-missing-field-initializers -Wno-maybe-uninitialized -Wno-stringop-overflow -Wno-array-bounds
                         -Wno-restrict -Wno-dangling-pointer)
endif()
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # A source's own types are not those of an included file, though it is included here.
  target_compile_options(pse_settings INTERFACE -Wno-subobject-linkage)
endif()
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # Only the fuzz targets are built with clang, whose warnings are not g++'s.
  target_compile_options(pse_settings INTERFACE -Wno-error)
endif()
if(PSE_SANITIZE)
  target_compile_options(pse_settings INTERFACE -fsanitize=${PSE_SANITIZE} -fno-omit-frame-pointer)
  if(PSE_NO_SANITIZE)
    target_compile_options(pse_settings INTERFACE -fno-sanitize=${PSE_NO_SANITIZE})
  endif()
  target_link_options(pse_settings INTERFACE -fsanitize=${PSE_SANITIZE})
endif()

# Half of what the compiler reads of a small file is the standard library: read once for the library, and once with
# GoogleTest for the tests. Sources name what they include all the same; the fuzz targets are built without this.
function(pse_precompile name)
  add_library(${name} OBJECT ${CMAKE_SOURCE_DIR}/cmake/precompiled.cpp)
  target_link_libraries(${name} PRIVATE pse_settings)
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
  target_precompile_headers(${name} PRIVATE ${ARGN} <algorithm> <array> <cmath> <expected> <functional>
                            <map> <memory> <optional> <span> <sstream> <string> <vector>)
endfunction()
if(PSE_PRECOMPILE)
  pse_precompile(pse_precompiled)
endif()

# pse_folder(name [USES folder...] [LINKS target...]): the static library pse_<name> of all .cpp files here.
# USES names the folders of src/ this one may include; scripts/check_includes.py holds them to it.
function(pse_folder name)
  cmake_parse_arguments(arg "" "" "USES;LINKS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  if(sources)
    add_library(pse_${name} STATIC ${sources})
    set(scope PUBLIC)
  else()
    add_library(pse_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_link_libraries(pse_${name} ${scope} pse_settings)
  if(PSE_PRECOMPILE AND sources)
    target_compile_options(pse_${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
    target_precompile_headers(pse_${name} REUSE_FROM pse_precompiled)
  endif()
  foreach(used ${arg_USES})
    target_link_libraries(pse_${name} ${scope} pse_${used})
  endforeach()
  if(arg_LINKS)
    if(sources)
      target_link_libraries(pse_${name} PRIVATE ${arg_LINKS})
    else()
      target_link_libraries(pse_${name} INTERFACE ${arg_LINKS})
    endif()
  endif()
endfunction()

# pse_tests(name [APART] [USES folder...] [LINKS target...]): one GoogleTest program of all .cpp files here.
# APART: names in the unnamed namespaces of its files are the same, so they are never compiled several at a time.
function(pse_tests name)
  cmake_parse_arguments(arg "APART" "" "USES;LINKS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE pse_settings GTest::gtest_main ${arg_LINKS})
  foreach(used ${arg_USES})
    target_link_libraries(test_${name} PRIVATE pse_${used})
  endforeach()
  target_compile_definitions(test_${name} PRIVATE PSE_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  # A test runs its own lines once; what they call is optimised as always.
  target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  # A file's helpers may hide those of another.
  if(arg_APART)
    set_target_properties(test_${name} PROPERTIES UNITY_BUILD OFF)
  else()
    set_target_properties(test_${name} PROPERTIES
                          UNITY_BUILD_CODE_BEFORE_INCLUDE "#pragma GCC diagnostic ignored \"-Wshadow\"")
  endif()
  if(PSE_PRECOMPILE)
    if(NOT TARGET pse_precompiled_tests)
      pse_precompile(pse_precompiled_tests <gtest/gtest.h>)
      target_link_libraries(pse_precompiled_tests PRIVATE GTest::gtest_main)
      # As programs are compiled, not libraries.
      set_target_properties(pse_precompiled_tests PROPERTIES POSITION_INDEPENDENT_CODE OFF)
      target_compile_options(pse_precompiled_tests PRIVATE -fPIE $<$<CONFIG:Release>:-O1>)
    endif()
    target_compile_options(test_${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
    target_precompile_headers(test_${name} REUSE_FROM pse_precompiled_tests)
  endif()
  add_test(NAME ${name} COMMAND test_${name} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
endfunction()
