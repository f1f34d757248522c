# What a hand feels with remote and with local rendering: a row for each class of scenes, in it a line for each network.
title = 'Displayed stiffness and error at the device, with remote and with local rendering'
subtitle = subtitle.' The worst scene of each class'
groups = all = ''
stats data using (groups = with_item(groups, strcol('class')), all = with_item(all, strcol('condition')), 0) nooutput

row_px = 12 + 9 * words(all)
top = head_px + 36 + 18 * ceil((words(all) + 3) / 3.)
height = top + row_px * words(groups) + 60
eval(begin(1000, height))
set output name.'.png'

aside(condition) = (place_of(all, condition) - (words(all) + 1) / 2.) * 0.8 / words(all)
y(group, condition) = place_of(groups, group) + aside(condition)
inside(value) = value < least ? least : value > most ? most : value
shown(quantity, n) = strcol('condition') eq word(all, n) && strcol(quantity) ne 'nan' ? inside(column(quantity)) : NaN
beside(quantity) = strcol(quantity) eq 'nan' ? NaN : inside(column(quantity))

set multiplot
eval(show_title)
eval(only_key(head_px))
plot for [n = 1:words(all)] NaN with points pointtype 7 linecolor rgb colour_of_network(n) title word(all, n), \
    NaN with points pointtype 7 linecolor rgb quiet title 'local rendering', \
    NaN with points pointtype 6 linewidth 1.5 linecolor rgb quiet title 'remote rendering', \
    NaN with lines linewidth 2 linecolor rgb ink title 'wanted; without a network'

eval(after_key)
set yrange [words(groups) + 0.5:0.5]
set tmargin at screen from_top(top)
set bmargin at screen from_top(height - 60)
set format x '%g'
set grid noytics
do for [i = 1:words(groups):2] {
  set object i rectangle from graph 0, first i - 0.5 to graph 1, first i + 0.5 behind fillcolor rgb '#f4f6f8' \
      fillstyle solid noborder
}
set ytics ()
set for [i = 1:words(groups)] ytics add (word(groups, i) i)
do for [panel = 1:2] {
  if (panel == 1) {
    least = 0
    most = 1.25
    quantity = 'stiffness'
    reference = 'wanted_stiffness'
    set xrange [-0.02:1.28]
    set xtics 0.2
    set xlabel 'displayed stiffness over that without a network'
    set label 10 'Stiffness: at or beyond the line is wanted' at graph 0.5, screen from_top(top - 14) center \
        font 'DejaVu Sans Bold,11' textcolor rgb ink
    set lmargin at screen 0.17
    set rmargin at screen 0.57
  } else {
    least = 0.001
    most = 5.
    quantity = 'error'
    reference = 'without_error'
    set logscale x
    set xrange [0.0008:6]
    set xtics ('≤ 0.001' 0.001, '0.01' 0.01, '0.1' 0.1, '1' 1, '≥ 5' 5)
    set xlabel 'E_dev'
    set label 10 'Error: at the line is as without a network'
    set lmargin at screen 0.59
    set rmargin at screen 0.98
    set ytics format '' ()
  }
  plot data using (beside(reference)):(place_of(groups, strcol('class')) - 0.45):(0):(0.9) with vectors nohead \
          linewidth 2 linecolor rgb ink notitle, \
      for [n = 1:words(all)] data using (shown('remote_'.quantity, n)):(y(strcol('class'), word(all, n))) \
          with points pointtype 6 pointsize 1 linewidth 1.5 linecolor rgb colour_of_network(n) notitle, \
      for [n = 1:words(all)] data using (shown('local_'.quantity, n)):(y(strcol('class'), word(all, n))) \
          with points pointtype 7 pointsize 1 linecolor rgb colour_of_network(n) notitle
}
unset multiplot
