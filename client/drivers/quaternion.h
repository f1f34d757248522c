/* Rotations. */
#ifndef FORCEBOUND_DRIVERS_QUATERNION_H
#define FORCEBOUND_DRIVERS_QUATERNION_H

#include <math.h>

/* The unit quaternion w, x, y, z of a rotation given by rows. */
static inline void to_quaternion(double r[3][3], double q[4]) {
  const double trace = r[0][0] + r[1][1] + r[2][2];
  if (trace > 0) {
    const double s = 2 * sqrt(1 + trace);
    q[0] = 0.25 * s;
    q[1] = (r[2][1] - r[1][2]) / s;
    q[2] = (r[0][2] - r[2][0]) / s;
    q[3] = (r[1][0] - r[0][1]) / s;
  } else {
    const int i = r[0][0] >= r[1][1] && r[0][0] >= r[2][2] ? 0 : r[1][1] >= r[2][2] ? 1 : 2;
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const double s = 2 * sqrt(1 + r[i][i] - r[j][j] - r[k][k]);
    q[0] = (r[k][j] - r[j][k]) / s;
    q[1 + i] = 0.25 * s;
    q[1 + j] = (r[j][i] + r[i][j]) / s;
    q[1 + k] = (r[k][i] + r[i][k]) / s;
  }
}

#endif
