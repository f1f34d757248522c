# What all figures share. `name` of the files, and a figure's own `title` and `subtitle`, are set above or below.
set encoding utf8
set datafile separator comma
set datafile columnheaders
data = name.'.csv'

ink = '#24292f'
quiet = '#57606a'
faint = '#e3e6ea'
red = '#c1272d'
orange = '#d9730d'
blue = '#0b5fa5'
green = '#1a8754'
violet = '#7b4fa3'
brown = '#8c6d46'
grey = '#b0b0b0'

# Told apart with the common colour blindnesses as well.
colour_of_law(law) = law eq 'none' ? red : law eq 'fba-less' ? orange : law eq 'fba-more' ? blue : \
    law eq 'fba-exact' ? green : law eq 'aol' ? '#c9a227' : law eq 'eba' ? '#5f6b76' : law eq 'mbpa' ? brown : \
    law eq 'pspm' ? '#4b9da9' : law eq 'sfa' ? '#b5838d' : law eq 'tdpa' ? violet : law eq 'tdpa-2port' ? '#a98bc9' : \
    law eq 'tla' ? '#6a994e' : law eq 'vc' ? '#e07a5f' : law eq 'wave' ? '#3d405b' : quiet
# From near to far.
network_colours = '#7fb2dd #0b5fa5 #d9730d #7b1e3a #1a8754 #7b4fa3 #8c6d46 #5f6b76 #c1272d #24292f'
colour_of_network(i) = word(network_colours, (i - 1) % words(network_colours) + 1)

# Lists of quoted words, for `for [x in list]`: those of a column in their order, and an item's place in them.
with_item(list, item) = strstrt(list, '"'.item.'"') ? list : list.'"'.item.'" '
place_of(list, item) = sum [i = 1:words(list)] (word(list, i) eq item ? i : 0)

head_px = 66
begin(width, height) = sprintf("set terminal pngcairo noenhanced rounded size %d,%d font 'DejaVu Sans,11' \
    background rgb '#ffffff'", width, height)
# A place counted in pixels from the picture's upper edge, as a share of its height.
from_top(pixels) = 1 - pixels / real(height)

set border 3 linecolor rgb grey
set tics nomirror out scale 0.6 textcolor rgb ink
set grid xtics ytics back linetype 1 linewidth 1 linecolor rgb faint
set key textcolor rgb ink
show_title = "set label 1 title at screen 0.5, screen from_top(22) center font 'DejaVu Sans Bold,14' textcolor rgb ink; \
    set label 2 subtitle at screen 0.5, screen from_top(46) center font ',10' textcolor rgb quiet"

# A figure whose panels stand side by side has its key in a plot of its own, as wide as the picture.
only_key(pixels) = sprintf("unset border; unset tics; set lmargin at screen 0.02; set rmargin at screen 0.98; \
    set tmargin at screen from_top(%d - 1); set bmargin at screen from_top(%d); set xrange [0:1]; set yrange [0:1]; \
    set key at screen 0.5, screen from_top(%d) center top horizontal maxrows 1 Left reverse samplen 2", \
    pixels, pixels, pixels)
after_key = "unset key; unset label 1; unset label 2; set border 3 linecolor rgb grey; \
    set xtics nomirror out scale 0.6 textcolor rgb ink; set ytics nomirror out scale 0 textcolor rgb ink"

key_above = 'set key at graph 1, graph 1.01 right bottom horizontal maxrows 1 Left reverse samplen 2'
no_data = "set label 11 'no data' at graph 0.5, graph 0.5 center textcolor rgb quiet; \
    plot [][0:1] NaN notitle; unset label 11"
