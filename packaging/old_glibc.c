// What lets modules that g++ 12 of Debian 12 makes run on glibc 2.28.
//
// The wheels are linked against the C library of an older Debian, which lacks two things that the static
// libstdc++ wants of its own one; and three functions whose newer variants, which differ in how they report
// errors alone, came with glibc 2.29. Linked into each module with --wrap for these three.
#include <stdint.h>
#include <stdlib.h>
#include <sys/random.h>

double old_exp(double x);
double old_log(double x);
double old_pow(double x, double y);
__asm__(".symver old_exp, exp@GLIBC_2.2.5");
__asm__(".symver old_log, log@GLIBC_2.2.5");
__asm__(".symver old_pow, pow@GLIBC_2.2.5");

double __wrap_exp(double x) { return old_exp(x); }
double __wrap_log(double x) { return old_log(x); }
double __wrap_pow(double x, double y) { return old_pow(x, y); }

// Counts of shared pointers are always atomic: what is right with and without threads.
char __libc_single_threaded = 0;

// For std::random_device.
uint32_t arc4random(void) {
  uint32_t number;
  if (getrandom(&number, sizeof number, 0) != sizeof number) abort();
  return number;
}
