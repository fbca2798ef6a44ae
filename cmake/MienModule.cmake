# mien_module(name SOURCES ... HEADERS ... DEPENDS rooms ... LINK private-libraries ...)
# One room: include/mien/<name>/ is its own include root, so a room that is not in DEPENDS cannot be included.
# mien_room_test(name SOURCES ... LINK ...): the room's GoogleTest program, mien_<name>_test.

# Language and warnings of every target of ours; never of a dependency.
function(mien_language_flags target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                                           -ffp-contract=off)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)  # false alarms on "literal" + std::string, GCC bug 105651
  endif()
  if(MIEN_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# Flags of libraries and programs: the sanitizers too.
function(mien_target_flags target)
  mien_language_flags(${target})
  if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)  # takes a source in a unit for a header
  endif()
  if(MIEN_SANITIZE STREQUAL "address")
    target_compile_options(${target} PRIVATE -O1 -g1 -UNDEBUG -fsanitize=address,undefined -fno-sanitize-recover=all
                                             -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  elseif(MIEN_SANITIZE STREQUAL "thread")
    target_compile_options(${target} PRIVATE -O1 -g1 -fsanitize=thread)
    target_link_options(${target} PUBLIC -fsanitize=thread)
  endif()
endfunction()

function(mien_module name)
  cmake_parse_arguments(M "" "" "SOURCES;HEADERS;DEPENDS;LINK" ${ARGN})
  add_library(mien_${name} STATIC ${M_SOURCES})
  add_library(mien::${name} ALIAS mien_${name})
  list(TRANSFORM M_HEADERS PREPEND include/mien/${name}/)
  target_sources(mien_${name} PUBLIC FILE_SET HEADERS BASE_DIRS include FILES ${M_HEADERS})
  mien_target_flags(mien_${name})
  list(TRANSFORM M_DEPENDS PREPEND mien::)
  target_link_libraries(mien_${name} PUBLIC ${M_DEPENDS} PRIVATE ${M_LINK})
  set_target_properties(mien_${name} PROPERTIES EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ON)
  if(MIEN_INSTALL)
    install(TARGETS mien_${name} EXPORT mienTargets FILE_SET HEADERS)
  endif()
endfunction()

# A test program: its own code need not be fast, but there is much of it, and it compiles in 60 to 80 % of the time.
# The address sanitizer watches what is tested, not the tests: their objects are then those of the release build, and
# a compiler cache gives them to both; so they are no unity build either. The thread sanitizer has to see all threads.
function(mien_test_flags target)
  if(MIEN_SANITIZE STREQUAL "address")
    mien_language_flags(${target})
  else()
    mien_target_flags(${target})
  endif()
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
endfunction()

# The tests of a GoogleTest program as prefix.Suite.Test, each in a process of its own. A process with a sanitizer takes
# half a second to start: there the program runs as target.1 and target.2, each with half of the tests.
function(mien_add_tests target prefix timeout)
  if(NOT MIEN_SANITIZE)
    gtest_discover_tests(${target} TEST_PREFIX ${prefix}. DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT ${timeout} ${ARGN})
    return()
  endif()
  foreach(part IN ITEMS 1 2)
    add_test(NAME ${target}.${part} COMMAND ${target} --gtest_brief=1)
    math(EXPR index "${part} - 1")
    set_tests_properties(${target}.${part} PROPERTIES TIMEOUT 1800 ${ARGN}
                         ENVIRONMENT "GTEST_TOTAL_SHARDS=2;GTEST_SHARD_INDEX=${index}")
  endforeach()
endfunction()

function(mien_room_test name)
  if(NOT MIEN_TESTS)
    return()
  endif()
  cmake_parse_arguments(T "" "" "SOURCES;LINK" ${ARGN})
  add_executable(mien_${name}_test ${T_SOURCES})
  mien_test_flags(mien_${name}_test)
  target_link_libraries(mien_${name}_test PRIVATE mien::${name} mien_test_support ${T_LINK} GTest::gmock GTest::gtest_main)
  mien_add_tests(mien_${name}_test ${name} 600)
endfunction()
