#ifndef FORCEBOUND_SETTING_NUMBER_H
#define FORCEBOUND_SETTING_NUMBER_H

#include <locale.h>
#include <stdlib.h>

/* The whole of a setting as a number with a point, whatever the process's locale. 0: it is none. Needs _GNU_SOURCE. */
static int setting_number(const char* text, double* number) {
  const locale_t classic = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  char* end = NULL;
  if (classic == (locale_t)0) return 0;
  *number = strtod_l(text, &end, classic);
  freelocale(classic);
  return end != text && *end == '\0';
}

#endif
