# The ratios of deploy/bench as bars from 1.
title = 'Time of Forcebound over that of the reference'
subtitle = 'left of 1: faster (most clients: right of 1 is more); dashed: required bound; red bar: missed, green: met'
stats data using (column('ratio')) nooutput
rows = STATS_records
row_px = 40
height = head_px + row_px * rows + 60
eval(begin(1000, height))
set output name.'.png'

eval(show_title)
set tmargin at screen from_top(head_px)
set bmargin at screen from_top(height - 60)
set lmargin at screen 0.46
set rmargin at screen 0.95
set border 1
set logscale x
set xrange [STATS_min / 1.5 < 0.1 ? STATS_min / 1.5 : 0.1 : STATS_max * 1.5 > 10 ? STATS_max * 1.5 : 10]
set xtics ()
do for [power = -3:4] { set for [digit in '1 2 5'] xtics add (digit * 10.**power) }
set format x '%g'
set ytics scale 0 font ',9'
set yrange [rows + 0.6:0.4]
set xlabel 'ratio (logarithmic)'
set grid noytics
set style fill solid noborder
unset key
set arrow 1 from 1, graph 0 to 1, graph 1 nohead linewidth 1.5 linecolor rgb ink front
beside(ratio, bound) = ratio > bound ? (ratio > 1 ? ratio : 1) : bound > 1 ? bound : 1
hue(missed, bound) = missed > 0 ? 0xc1272d : bound > 0 ? 0x1a8754 : 0x0b5fa5
y(row) = row + 1
below(label) = strcol(label) eq '-' ? '' : "\n".strcol(label)
plot data using (1):(y($0)):(1):(column('ratio')):(y($0) - 0.3):(y($0) + 0.3): \
        (hue(column('missed'), column('bound'))):yticlabels(strcol('what').' / '.strcol('yardstick').below('conditions')) \
        with boxxyerror linecolor rgb variable, \
    data using (beside(column('ratio'), column('bound'))):(y($0)):(sprintf('%g', column('ratio'))) with labels left offset 0.6, 0 \
        textcolor rgb ink, \
    data using (column('bound') > 0 ? column('bound') : NaN):(y($0) - 0.42):(0):(0.84) with vectors nohead \
        linewidth 2 dashtype 2 linecolor rgb ink
