# The stiffest wall over the rate of the device's loop: a panel for each device, a curve for each law.
title = 'The stiffest wall that is displayed at rest, over the rate of the loop'
subtitle = 'solid: ideal device; dashed: its own encoder, 0.1 ms of latency; none at rest: no mark'
devices = laws = rates = ''
stats data using (devices = with_item(devices, strcol('device')), laws = with_item(laws, strcol('law')), \
    rates = with_item(rates, strcol('rate_Hz')), 0) nooutput

top = head_px + 60
height = 480
eval(begin(1000, height))
set output name.'.png'
of(device, law, column_name) = strcol('device') eq device && strcol('law') eq law && column(column_name) > 0 ? \
    column(column_name) : NaN

# Rows of other laws and devices lie between two points of a curve.
set datafile missing NaN
set multiplot
eval(show_title)
eval(only_key(head_px))
plot NaN with lines linewidth 1.5 linecolor rgb ink title '2b/T', \
    NaN with lines linewidth 1.5 dashtype 3 linecolor rgb quiet title 'b/(T/2 + 0.1 ms)', \
    for [law in laws] NaN with linespoints pointtype 7 pointsize 0.9 linewidth 1.6 linecolor rgb colour_of_law(law) \
        title law

eval(after_key)
set logscale xy
set xrange [420:4800]
set xtics ()
do for [rate in rates] { set xtics add (rate rate + 0) }
set yrange [*:*]
set tmargin at screen from_top(top)
set bmargin at screen from_top(height - 62)
set label 3 'ticks per second [1/s]' at screen 0.54, screen from_top(height - 18) center textcolor rgb ink
set label 4 'displayed stiffness [N/mm]' at screen 0.02, graph 0.5 center rotate textcolor rgb ink
width = 0.9 / words(devices)
do for [d = 1:words(devices)] {
  device = word(devices, d)
  set lmargin at screen 0.08 + (d - 1) * width
  set rmargin at screen 0.08 + d * width - 0.05
  set label 10 device at graph 0.5, screen from_top(top - 14) center font 'DejaVu Sans Bold,11' textcolor rgb ink
  plot data using (column('rate_Hz')):(of(device, word(laws, 1), 'passive_N_per_mm')) with lines linewidth 1.5 \
          linecolor rgb ink notitle, \
      data using (column('rate_Hz')):(of(device, word(laws, 1), 'late_N_per_mm')) with lines linewidth 1.5 \
          dashtype 3 linecolor rgb quiet notitle, \
      for [law in laws] data using (column('rate_Hz')):(of(device, law, 'ideal_N_per_mm')) with linespoints \
          pointtype 7 pointsize 0.9 linewidth 1.6 linecolor rgb colour_of_law(law) notitle, \
      for [law in laws] data using (column('rate_Hz')):(of(device, law, 'own_N_per_mm')) with linespoints \
          pointtype 6 pointsize 0.9 linewidth 1.2 dashtype 2 linecolor rgb colour_of_law(law) notitle
  unset label 3
  unset label 4
}
unset multiplot
