# What a hand feels with remote and with local rendering: a row for each class of scenes, in it a line for each network.
title = 'What is felt with local and with remote rendering'
groups = all = listed = ''
stats data using (groups = with_item(groups, strcol('class')), all = with_item(all, strcol('condition')), 0) nooutput
do for [condition in all] { listed = listed.(strlen(listed) ? ', ' : '').condition }
subtitle = subtitle.' A row for each class of scenes, of which the worst is shown; in it, from the top, a line for '. \
    'each network: '.listed

eval(begin_head)
eval(add_key('wanted (left), without a network (right)', ink, 0))
eval(add_key('local rendering', blue, 7))
eval(add_key('remote rendering', orange, 6))
row_px = 12 + 9 * words(all)
top = head_px + 30
height = top + row_px * words(groups) + axis_px
eval(begin(width, height))

aside(condition) = (place_of(all, condition) - (words(all) + 1) / 2.) * 0.8 / words(all)
y(group, condition) = place_of(groups, group) + aside(condition)
inside(value) = value < least ? least : value > most ? most : value
shown(quantity) = strcol(quantity) ne 'nan' ? inside(column(quantity)) : NaN

set multiplot
eval(show_head)
set format x '%g'
rows = groups
eval(show_rows)
gap_px = 48
panel_px = (width - left_px - 2 * edge_px - gap_px) / 2
do for [p = 1:2] {
  x_px = left_px + (p - 1) * (panel_px + gap_px)
  if (p == 1) {
    least = 0
    most = 1.25
    quantity = 'stiffness'
    reference_of = 'wanted_stiffness'
    set xrange [-0.02:1.28]
    set xtics 0.2
    set xlabel 'displayed stiffness over that without a network'
    eval(panel('Stiffness: at or right of the line is wanted', x_px, top, x_px + panel_px, height - axis_px))
  } else {
    least = 0.001
    most = 5.
    quantity = 'error'
    reference_of = 'without_error'
    set logscale x
    set xrange [0.0008:6]
    set xtics ('≤ 0.001' 0.001, '0.01' 0.01, '0.1' 0.1, '1' 1, '≥ 5' 5)
    set xlabel 'error of the force at the device (E_dev)'
    set ytics format '' ()
    eval(panel('Error: at the line is as without a network', x_px, top, x_px + panel_px, height - axis_px))
  }
  plot data using (shown(reference_of)):(place_of(groups, strcol('class')) - 0.45):(0):(0.9) with vectors nohead \
          linewidth 2 linecolor rgb ink, \
      data using (shown('remote_'.quantity)):(y(strcol('class'), strcol('condition'))) \
          with points pointtype 6 pointsize 1 linewidth 1.5 linecolor rgb orange, \
      data using (shown('local_'.quantity)):(y(strcol('class'), strcol('condition'))) \
          with points pointtype 7 pointsize 1 linecolor rgb blue
  eval(hide_head)
}
unset multiplot
