/* Preloaded into user-mode Linux: gives it its processes' registers on processors whose set is larger than its
 * buffer (those with AMX). The host hands out as much of the set as the buffer holds, but takes back only whole
 * sets; without this the kernel stops at its first system call. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <elf.h>
#include <stdarg.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

enum { LARGEST_SET = 65536 };

long ptrace(enum __ptrace_request request, ...) {
  static long (*host)(int, pid_t, void *, void *);
  static char set[LARGEST_SET];
  va_list rest;
  va_start(rest, request);
  pid_t process = va_arg(rest, pid_t);
  void *address = va_arg(rest, void *);
  void *argument = va_arg(rest, void *);
  va_end(rest);
  if (!host) *(void **)&host = dlsym(RTLD_NEXT, "ptrace");
  if (request != PTRACE_SETREGSET || address != (void *)NT_X86_XSTATE) return host(request, process, address, argument);

  const struct iovec *known = argument; /* what user-mode Linux knows of the set; the rest stays as it is */
  struct iovec whole = {set, LARGEST_SET};
  long failed = host(PTRACE_GETREGSET, process, address, &whole);
  if (failed) return failed;
  memcpy(set, known->iov_base, known->iov_len < whole.iov_len ? known->iov_len : whole.iov_len);
  return host(PTRACE_SETREGSET, process, address, &whole);
}
