# The ratios of deploy/bench as bars from 1, each beside what it is of.
title = 'Time of Forcebound over that of the reference'
subtitle = 'left of 1: faster, but of clients right of 1 is more; dashed: required bound, red where it is missed, green where it is met'
whats = subs = ''
below = ''
stats data using (whats = whats.'"'.strcol('what').'" ', below = 'beside '.strcol('yardstick').(strcol('conditions') eq '-' ? \
    '' : ', '.strcol('conditions')), subs = subs.'"'.below.'" ', 0) nooutput
stats data using (column('ratio')) nooutput
rows = STATS_records

eval(begin_head)
row_px = 38
names_px = 8 * longest(whats) > 6.8 * longest(subs) ? 8 * longest(whats) : 6.8 * longest(subs)
left_px = edge_px + names_px + 20
width = left_px + 520
top = head_px + 10
height = top + row_px * rows + axis_px
eval(begin(width, height))

eval(show_head)
set border 1
set logscale x
set xrange [STATS_min / 1.5 < 0.1 ? STATS_min / 1.5 : 0.1 : STATS_max * 1.8 > 10 ? STATS_max * 1.8 : 10]
set xtics ()
do for [power = -3:4] { set for [digit in '1 2 5'] xtics add (digit * 10.**power) }
set format x '%g'
unset ytics
set yrange [rows + 0.5:0.5]
set xlabel 'ratio (logarithmic)'
set grid noytics
set style fill solid noborder
do for [i = 1:rows] {
  set label 200 + i word(whats, i) at screen from_left(edge_px), screen from_top(top + (i - 0.5) * row_px - 8) left textcolor rgb ink
  set label 400 + i word(subs, i) at screen from_left(edge_px), screen from_top(top + (i - 0.5) * row_px + 8) left font ',9' \
      textcolor rgb quiet
  if (i % 2) {
    set object 100 + i rectangle from screen from_left(edge_px - 6), first i - 0.5 to graph 1, first i + 0.5 behind \
        fillcolor rgb '#f4f6f8' fillstyle solid noborder
  }
}
set arrow 1 from 1, graph 0 to 1, graph 1 nohead linewidth 1.5 linecolor rgb ink front
beside(ratio, bound) = ratio > bound ? (ratio > 1 ? ratio : 1) : bound > 1 ? bound : 1
hue(missed, bound) = missed > 0 ? 0xc1272d : bound > 0 ? 0x1a8754 : 0x0b5fa5
y(row) = row + 1
set lmargin at screen from_left(left_px)
set rmargin at screen from_left(width - edge_px)
set tmargin at screen from_top(top)
set bmargin at screen from_top(height - axis_px)
plot data using (1):(y($0)):(1):(column('ratio')):(y($0) - 0.25):(y($0) + 0.25): \
        (hue(column('missed'), column('bound'))) with boxxyerror linecolor rgb variable, \
    data using (beside(column('ratio'), column('bound'))):(y($0)):(sprintf('%g', column('ratio'))) with labels left offset 0.6, 0 \
        textcolor rgb ink, \
    data using (column('bound') > 0 ? column('bound') : NaN):(y($0) - 0.4):(0):(0.8) with vectors nohead \
        linewidth 2 dashtype 2 linecolor rgb ink
