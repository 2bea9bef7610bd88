# How every target of the project is compiled.
set(LUXEL_WARNINGS "" CACHE STRING "Warning options (presets set them)")
set(LUXEL_SANITIZE "" CACHE STRING "Value of -fsanitize= (presets set it)")

add_library(luxel_flags INTERFACE)
target_include_directories(luxel_flags INTERFACE "${CMAKE_SOURCE_DIR}")
# Nobody reads errno or floating-point traps; without these two, loops with roots and choices are not vectorised.
set(LUXEL_COMMON_FLAGS -fno-math-errno -fno-trapping-math)
if(LUXEL_INVARIANCE)
  # One instruction set and no contraction into fused multiply-add: the same bits on every machine.
  list(APPEND LUXEL_COMMON_FLAGS -march=x86-64-v3 -ffp-contract=off)
endif()
if(LUXEL_SANITIZE)
  list(APPEND LUXEL_COMMON_FLAGS -fsanitize=${LUXEL_SANITIZE} -fno-omit-frame-pointer)
  if(LUXEL_SANITIZE MATCHES "undefined")
    list(APPEND LUXEL_COMMON_FLAGS -fno-sanitize-recover=undefined)
  endif()
  target_link_options(luxel_flags INTERFACE -fsanitize=${LUXEL_SANITIZE})
  if(LUXEL_SANITIZE MATCHES "thread")
    target_compile_definitions(luxel_flags INTERFACE LUXEL_TSAN=1)
  endif()
endif()
target_compile_options(luxel_flags INTERFACE ${LUXEL_COMMON_FLAGS})
if(LUXEL_OWN_XATLAS)
  target_compile_options(xatlas PRIVATE ${LUXEL_COMMON_FLAGS})
  if(LUXEL_SANITIZE)
    target_link_options(xatlas PUBLIC -fsanitize=${LUXEL_SANITIZE})
    if(LUXEL_SANITIZE MATCHES "undefined" AND CMAKE_CXX_COMPILER_ID MATCHES "Clang")
      # It calls its C-style destructors through pointers of another type, which works everywhere; only clang looks.
      target_compile_options(xatlas PRIVATE -fno-sanitize=function)
    endif()
  endif()
endif()

# luxel_room(NAME SOURCES ... LINK ... PRIVATE_LINK ...): one static library per room, luxel::NAME.
# LINK names what its public headers need; PRIVATE_LINK what only its sources touch.
function(luxel_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(luxel_${name} STATIC ${ROOM_SOURCES})
  target_link_libraries(luxel_${name} PUBLIC luxel_flags ${ROOM_LINK} PRIVATE ${ROOM_PRIVATE_LINK})
  target_compile_options(luxel_${name} PRIVATE ${LUXEL_WARNINGS})
  add_library(luxel::${name} ALIAS luxel_${name})
endfunction()

# What calls the rooms and does not compute itself: a third less time to compile than with -O3, and nothing slower to run.
set(LUXEL_CALLER_FLAGS $<$<CONFIG:Release>:-O1>)

# luxel_test(NAME SOURCES ... LINK ...): one GoogleTest program; every TEST in it is a ctest case.
# LABEL long: not part of the short run.
function(luxel_test name)
  cmake_parse_arguments(T "" "LABEL;TIMEOUT" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${T_SOURCES})
  target_link_libraries(${name} PRIVATE luxel_flags ${T_LINK} GTest::gtest_main)
  target_compile_options(${name} PRIVATE ${LUXEL_WARNINGS} ${LUXEL_CALLER_FLAGS})
  if(NOT T_TIMEOUT)
    set(T_TIMEOUT 300)
  endif()
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES TIMEOUT ${T_TIMEOUT} LABELS "${T_LABEL}"
    ENVIRONMENT "LUXEL_SOURCE_DIR=${CMAKE_SOURCE_DIR};LUXEL_BINARY_DIR=${CMAKE_BINARY_DIR}")
endfunction()
