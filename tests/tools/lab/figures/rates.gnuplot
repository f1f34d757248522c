# The stiffest wall over the rate of the device's loop: a panel for each device, a curve for each law.
title = 'The stiffest wall that is displayed at rest, over the rate of the loop'
subtitle = 'filled: ideal device; hollow: its own encoder, 0.1 ms of latency; none at rest: no mark'
devices = laws = rates = ''
stats data using (devices = with_item(devices, strcol('device')), laws = with_item(laws, strcol('law')), \
    rates = with_item(rates, strcol('rate_Hz')), 0) nooutput

eval(begin_head)
do for [law in laws] { eval(add_key(law, colour_of_law(law), 7)) }
eval(add_key('2b/T', ink, 0))
eval(add_key('b/(T/2 + 0.1 ms)', quiet, -1))
left_px = 60
top = head_px + 30
height = top + 312 + axis_px
eval(begin(width, height))
of(device, law, column_name) = strcol('device') eq device && strcol('law') eq law && column(column_name) > 0 ? \
    column(column_name) : NaN

# Rows of other laws and devices lie between two points of a curve.
set datafile missing NaN
set multiplot
eval(show_head)
set logscale xy
set xrange [420:4800]
set xtics ()
do for [rate in rates] { set xtics add (rate rate + 0) }
set yrange [*:*]
set format y '%g'
set xlabel 'ticks per second [1/s]'
panel_px = (width - left_px - edge_px) / real(words(devices)) - 40
do for [d = 1:words(devices)] {
  device = word(devices, d)
  x_px = left_px + (d - 1) * (panel_px + 40)
  eval(panel(device.(d == 1 ? ': displayed stiffness [N/mm]' : ''), x_px, top, x_px + panel_px, height - axis_px))
  plot data using (column('rate_Hz')):(of(device, word(laws, 1), 'passive_N_per_mm')) with lines linewidth 1.5 \
          linecolor rgb ink, \
      data using (column('rate_Hz')):(of(device, word(laws, 1), 'late_N_per_mm')) with lines linewidth 1.5 \
          dashtype 3 linecolor rgb quiet, \
      for [law in laws] data using (column('rate_Hz')):(of(device, law, 'ideal_N_per_mm')) with linespoints \
          pointtype 7 pointsize 0.9 linewidth 1.6 linecolor rgb colour_of_law(law), \
      for [law in laws] data using (column('rate_Hz')):(of(device, law, 'own_N_per_mm')) with linespoints \
          pointtype 6 pointsize 0.9 linewidth 1.2 dashtype 2 linecolor rgb colour_of_law(law)
  eval(hide_head)
}
unset multiplot
