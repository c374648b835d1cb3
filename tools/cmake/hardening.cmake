# What makes a fault of memory in a release harder to abuse: canaries on the stack, checked calls of the C library, tables
# of addresses that nothing can write after the start, a place in memory that differs from start to start and, where the
# processor and the C library take part, targets of jumps that are marked. Debug builds have the sanitizers instead.
# bench/README.md has what it costs; tests/sources/hardening_test.cpp reads it out of what was built.
option(SIMVIS_HARDENING "Harden releases; OFF is for measuring what that costs" ON)
include(CheckPIESupported)
check_pie_supported()  # programs are then linked at no fixed place too: CMAKE_POSITION_INDEPENDENT_CODE

set(simvis_hardening)
if(SIMVIS_HARDENING)
  set(simvis_hardening -fstack-protector-strong -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND simvis_hardening -fcf-protection=full)
  elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|ARM64")
    list(APPEND simvis_hardening -mbranch-protection=standard)
  endif()
  list(TRANSFORM simvis_hardening REPLACE "(.+)" "$<$<CONFIG:Release>:\\1>")
  add_link_options("$<$<CONFIG:Release>:LINKER:-z,relro,-z,now>")
endif()
add_compile_options(${simvis_hardening})
