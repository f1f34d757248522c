# What each architecture costs: force error and tracking error, a row for each network and architecture, in it a mark for
# each task.
title = 'What each architecture costs behind each network, with a law and without'
subtitle = 'a mark for each task, medians over seeds; the bar is the median of the tasks'
networks = architectures = laws = ''
stats data using (networks = with_item(networks, strcol('network')), laws = with_item(laws, strcol('law')), \
    architectures = with_item(architectures, strcol('architecture')), 0) nooutput

eval(begin_head)
do for [law in laws] { eval(add_key(law eq 'none' ? 'none: without a law, not passive' : law, colour_of_law(law), law eq 'none' ? 6 : 7)) }
row_px = 13 + 9 * words(laws)
group = words(architectures) + 1
count = words(networks) * group
top = head_px + 30
height = top + row_px * count + axis_px
eval(begin(width, height))

# A line of each group is its heading.
row_of(network, architecture) = (place_of(networks, network) - 1) * group + 1 + place_of(architectures, architecture)
y(law) = row_of(strcol('network'), strcol('architecture')) + aside(law)
aside(law) = (place_of(laws, law) - (words(laws) + 1) / 2.) * 0.36
shown(quantity, law) = strcol('law') eq law && column(quantity) > 0 ? column(quantity) : NaN

# The median of each row's tasks.
quantities = 'force_N tracking_mm'
array least[2]
array most[2]
set print $middle
do for [p = 1:2] {
  quantity = word(quantities, p)
  stats data using (column(quantity) > 0 ? column(quantity) : NaN) name 'X' nooutput
  least[p] = X_min
  most[p] = X_max
  do for [law in laws] { do for [network in networks] { do for [architecture in architectures] {
    of_row(quantity) = strcol('network') eq network && strcol('architecture') eq architecture ? shown(quantity, law) : NaN
    known = 0
    stats data using (value = of_row(quantity), known = value == value ? 1 : known, 0) nooutput
    if (known) {
      stats data using (of_row(quantity)) name 'M' nooutput
      print sprintf('%d,%s,%g,%g', p, law, M_median, row_of(network, architecture) + aside(law))
    }
  }}}
}
set print

set multiplot
eval(show_head)
set logscale x
set yrange [count + 0.5:0.5]
set grid noytics
set ytics scale 0 ()
do for [n = 1:words(networks)] {
  first_row = (n - 1) * group + 1
  set label 60 + n word(networks, n) eq 'none' ? 'no network' : word(networks, n) at screen from_left(edge_px), \
      screen from_top(top + (first_row - 0.5) * row_px) left font bold(11) textcolor rgb ink
  do for [a = 1:words(architectures)] { set ytics add (word(architectures, a) first_row + a) }
  if (n % 2) {
    set object 100 + n rectangle from graph 0, first first_row - 0.5 to graph 1, first first_row + group - 0.5 \
        behind fillcolor rgb '#f4f6f8' fillstyle solid noborder
  }
}
left_px = edge_px + 16 + 9 * longest(architectures)
gap_px = 40
panel_px = (width - left_px - 2 * edge_px - gap_px) / 2
set format x '%g'
do for [p = 1:2] {
  x_px = left_px + (p - 1) * (panel_px + gap_px)
  quantity = word(quantities, p)
  set xrange [least[p] * 0.8:most[p] * 1.25]
  set xtics ()
  do for [power = -3:4] { set for [digit in '1 2 5'] xtics add (digit * 10.**power) }
  if (p == 2) { set ytics format '' () }
  set xlabel p == 1 ? 'force error at the hand in contact [N]' : 'tracking error of the tool [mm]'
  eval(panel(p == 1 ? 'Force error: left is better' : 'Tracking error: left is better', x_px, top, x_px + panel_px, height - axis_px))
  plot for [law in laws] data using (shown(quantity, law)):(y(law)) with points pointtype (law eq 'none' ? 6 : 7) \
          pointsize 0.7 linewidth 1.2 linecolor rgb colour_of_law(law), \
      for [law in laws] $middle using (column(1) == p && strcol(2) eq law ? column(3) : NaN):(column(4) - 0.2):(0):(0.4) with vectors nohead \
          linewidth 4 linecolor rgb colour_of_law(law)
  eval(hide_head)
  do for [n = 1:words(networks)] { unset label 60 + n }
}
unset multiplot
