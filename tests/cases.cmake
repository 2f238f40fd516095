# SPDX-License-Identifier: GPL-2.0-or-later
# Tests that are no unit files: the floors of the house, the runner of the cases, the cases themselves
# (see cases/README.md). To be included at the end of CMakeLists.txt, when all other tests are known.

find_program(BASH_PROGRAM bash REQUIRED)

add_test(NAME layering
  COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_SOURCE_DIR} -P ${CMAKE_CURRENT_LIST_DIR}/layering.cmake)
add_test(NAME layering_self_test
  COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_SOURCE_DIR}
    -DSELF_TEST=${CMAKE_CURRENT_BINARY_DIR}/layering_self_test
    -P ${CMAKE_CURRENT_LIST_DIR}/layering.cmake)
add_test(NAME run_case_self_test
  COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_LIST_DIR}/run_case_self_test.sh
    ${CMAKE_CURRENT_BINARY_DIR}/run_case_self_test)
set_tests_properties(layering layering_self_test run_case_self_test PROPERTIES LABELS quick TIMEOUT 60)

# The value of "key: value" in a case.conf, or the default.
function(axiforge_case_entry file key default result)
  set(value "${default}")
  file(STRINGS ${file} lines REGEX "^${key}:")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^${key}:[ \t]*" "" value "${line}")
    string(STRIP "${value}" value)
  endforeach()
  set(${result} "${value}" PARENT_SCOPE)
endfunction()

if(TARGET axiforge)
  file(GLOB case_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/cases/*/case.conf)
  foreach(file IN LISTS case_files)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    get_filename_component(folder ${file} DIRECTORY)
    get_filename_component(name ${folder} NAME)
    axiforge_case_entry(${file} labels "" labels)
    axiforge_case_entry(${file} timeout 300 timeout)
    axiforge_case_entry(${file} ranks 1 ranks)
    separate_arguments(labels)
    add_test(NAME case_${name}
      COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_LIST_DIR}/run_case.sh
        $<TARGET_FILE:axiforge> ${folder} ${CMAKE_CURRENT_BINARY_DIR}/cases/${name})
    set_tests_properties(case_${name} PROPERTIES
      LABELS "case;${labels}" TIMEOUT ${timeout} PROCESSORS ${ranks}
      ENVIRONMENT "AXIFORGE_MPIRUN=${MPIEXEC_EXECUTABLE}")
    axiforge_own_temporary_folder(case_${name})
  endforeach()

  # The program takes half a second to start: a few ctest cases for all faults, not one for each.
  file(GLOB fault_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/cases/faults/*.fault)
  list(LENGTH fault_files n_faults)
  math(EXPR n_parts "(${n_faults} + 14) / 15")
  if(n_parts GREATER 0)
    math(EXPR last_part "${n_parts} - 1")
    foreach(part RANGE ${last_part})
      math(EXPR number "${part} + 1")
      add_test(NAME faults_${number}
        COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_LIST_DIR}/run_faults.sh $<TARGET_FILE:axiforge>
          ${CMAKE_CURRENT_LIST_DIR}/cases/faults ${CMAKE_CURRENT_BINARY_DIR}/cases/faults_${number}
          ${part} ${n_parts})
      set_tests_properties(faults_${number} PROPERTIES LABELS "case;quick" TIMEOUT 300
        ENVIRONMENT "AXIFORGE_MPIRUN=${MPIEXEC_EXECUTABLE}")
      axiforge_own_temporary_folder(faults_${number})
    endforeach()
  endif()
endif()

# The short form of the stress tests (doc/stability.md), a case for each group. They need nothing but python3.
find_program(PYTHON3_PROGRAM python3)
if(TARGET axiforge AND PYTHON3_PROGRAM)
  foreach(group penalty scaling invariance friction material steps shapes random_scenes industrial)
    add_test(NAME stress_${group}
      COMMAND ${PYTHON3_PROGRAM} ${CMAKE_SOURCE_DIR}/benchmarks/stress/stress.py $<TARGET_FILE:axiforge>
        ${group} --short)
    set_tests_properties(stress_${group} PROPERTIES LABELS case TIMEOUT 300)
  endforeach()

  # The tables of doc/stability.md are those of the results.
  add_test(NAME documentation_tables
    COMMAND ${PYTHON3_PROGRAM} ${CMAKE_SOURCE_DIR}/benchmarks/stress/summary.py --check)
  set_tests_properties(documentation_tables PROPERTIES LABELS case)
endif()

# What the tests labelled "quick" need, and no more: the Debug build makes this target. A test without a
# time limit of its own gets one.
add_custom_target(quick_tests)
get_property(all_tests DIRECTORY PROPERTY TESTS)
foreach(test IN LISTS all_tests)
  get_test_property(${test} LABELS labels)
  get_test_property(${test} TIMEOUT timeout)
  if(NOT timeout)
    set_tests_properties(${test} PROPERTIES TIMEOUT 300)
  endif()
  if("quick" IN_LIST labels)
    if(TARGET ${test})
      add_dependencies(quick_tests ${test})
    elseif("case" IN_LIST labels)
      add_dependencies(quick_tests axiforge)
    endif()
  endif()
endforeach()
