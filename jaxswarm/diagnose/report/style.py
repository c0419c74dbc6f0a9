"""The style sheet of the page: readable at any width, light or dark, on a screen or on paper."""

STYLE = """
:root{color-scheme:light dark;--page:#fff;--text:#1c2429;--soft:#5b6770;--line:#d5dbe0;--box:#f3f6f8;
--accent:#2e6f95;--warn:#a32a3c;--warnbox:#fbecee;--measured:#5b6770;--model:#d1495b}
@media (prefers-color-scheme:dark){:root{--page:#14191d;--text:#e3e8eb;--soft:#9aa7b0;--line:#36414a;
--box:#1d252b;--accent:#6db3dc;--warn:#ff8d9b;--warnbox:#3a2026;
--measured:#a9b6bf;--model:#ff7d8e}
img{filter:invert(.92) hue-rotate(180deg)}}
*{box-sizing:border-box}
body{font:16px/1.5 system-ui,-apple-system,"Segoe UI",sans-serif;color:var(--text);background:var(--page);
max-width:72rem;margin:0 auto;padding:1rem;overflow-wrap:anywhere}
h1{font-size:1.15rem;font-weight:500;color:var(--soft);margin:.5rem 0}
h2{font-size:1.25rem;margin:2.2rem 0 .5rem}h3{font-size:1.02rem;margin:1.2rem 0 .3rem}
p,ul{max-width:48rem;margin:.5rem 0}ul{padding-left:1.3rem}
small,figcaption,.soft{color:var(--soft);font-size:.88rem}
.verdict{border-left:6px solid var(--accent);background:var(--box);padding:.9rem 1.1rem}
.verdict strong{display:block;font-size:1.9rem;line-height:1.2;margin-bottom:.4rem}
.verdict p{font-size:1.15rem;margin:0;max-width:60rem}.proof{font-weight:600}
.flags{border-left:6px solid var(--warn);background:var(--warnbox);padding:.6rem 1.1rem;margin:1rem 0}
.flags h3{margin:0}
.formula{font-family:ui-monospace,monospace;background:var(--box);padding:.4rem .7rem}
.scroll{overflow-x:auto;max-width:100%;margin:.5rem 0}
.scroll table{border-collapse:collapse;overflow-wrap:normal}
td,th{padding:.28rem .75rem;border-bottom:1px solid var(--line);text-align:left;vertical-align:top}
th{background:var(--box);font-weight:600;white-space:nowrap}
td{white-space:nowrap}td.n{text-align:right;font-variant-numeric:tabular-nums}th.n{text-align:right}
td.w{min-width:14rem;white-space:normal}
.heads th{white-space:normal;overflow-wrap:anywhere;vertical-align:bottom}
.heads td,.heads th{padding:.28rem .3rem;font-size:.87rem}
.heads td.w{min-width:9rem}
tr.far td{background:var(--warnbox);color:var(--warn);font-weight:600}
@media screen and (max-width:40rem){td,th{padding:.28rem .35rem;font-size:.92rem}
.wide table,.wide tbody{display:block}.wide thead{display:none}
.wide tr{display:grid;grid-template-columns:repeat(auto-fill,minmax(8.5rem,1fr));column-gap:1.2rem;
border-bottom:1px solid var(--line);padding:.4rem .3rem}
.wide td{display:flex;justify-content:space-between;gap:.6rem;border:0;padding:.05rem 0;min-width:0;
white-space:normal;text-align:right;overflow-wrap:anywhere}
.wide td::before{content:attr(data-head);color:var(--soft);font-weight:400;text-align:left;overflow-wrap:normal;
white-space:normal}
.wide td.n{white-space:nowrap}.wide tr.far{background:var(--warnbox)}
.wide td.l,.wide td.w,.wide td:first-child{grid-column:1/-1}
.wide td.w,.wide td:first-child{display:block;text-align:left}
.wide td.w::before{display:block}.wide td:first-child{font-weight:600}.wide td:first-child::before{content:none}
.wide tr>td:empty{display:none}}
.signal{margin:.5rem 0;outline-offset:3px}.signal figcaption{display:flex;flex-wrap:wrap;gap:.1rem .6rem}
.signal b{color:var(--text)}.signal output{color:var(--text);font-variant-numeric:tabular-nums}
.signal svg{display:block;width:100%;height:13rem;background:var(--box);touch-action:pan-y;cursor:crosshair}
.signal path{fill:none;vector-effect:non-scaling-stroke;stroke-width:1.3}
.signal line{vector-effect:non-scaling-stroke;stroke-width:1}.zero{stroke:var(--line)}.at{stroke:var(--text)}
path.measured{stroke:var(--measured)}path.model{stroke:var(--model)}path.rest{stroke:var(--accent)}
.live .signal output{flex-basis:100%;min-height:1.4em}
.chosen{fill:var(--accent);opacity:.25}
.key{display:inline-block;width:1.6rem;height:.25rem;vertical-align:middle;background:var(--measured)}
.key.model{background:var(--model)}.key.rest{background:var(--accent)}
.zooming button{font:inherit;padding:.15rem .6rem}
figure{margin:.8rem 0}figure img{display:block;max-width:100%;min-width:40rem;height:auto}
details{border:1px solid var(--line);padding:.5rem .9rem;margin:.8rem 0}
summary{cursor:pointer;font-weight:600}
a{color:var(--accent)}
@media print{:root{--page:#fff;--text:#000;--soft:#444;--line:#bbb;--box:#f4f4f4;--accent:#2e6f95;
--warn:#a32a3c;--warnbox:#fbecee;--measured:#5b6770;--model:#d1495b}.zooming{display:none}html{font-size:11px}body{max-width:none;padding:0;font-size:1rem}
img{filter:none}figure img{min-width:0;max-height:22cm}
.signal svg{height:4cm}figure,tr,.verdict,.flags{break-inside:avoid}h2,h3{break-after:avoid}
.scroll{overflow:visible}td,th{padding:.15rem .35rem;white-space:normal}td.n{white-space:nowrap}
td.w,.heads td.w{min-width:0}th{white-space:normal;overflow-wrap:anywhere}.download{display:none}
.formula{border:1px solid var(--line)}}
@media print{details::details-content{content-visibility:visible;display:block}}
"""
