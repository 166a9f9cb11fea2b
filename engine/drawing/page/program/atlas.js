// The page of an atlas (gdtslam fleet finish): totals, a card for each map, and the logs that are not mapped.

const kPerPage = 60;
const kOrders = {  // by these; the largest first
  name: ['by name', null], path: ['longest path', (row) => row.path_m], area: ['largest map', (row) => row.width_m * row.height_m],
  doubtful: ['most doubtful', (row) => row.doubtful / Math.max(1, row.scans)], cpu: ['slowest', (row) => row.cpu_s],
};

function durationText(seconds) {
  if (seconds < 90) return `${Math.round(seconds)} s`;
  const minutes = Math.round(seconds / 60);
  return minutes < 90 ? `${minutes} min` : `${grouped(minutes / 60)} h`;
}

const words = (tag, textContent, className = '') => element(tag, {textContent, className});
const link = (textContent, href) => element('a', {textContent, href});

function cardOf(row) {
  const view = element('a', {href: row.overview || row.run + '/', className: 'picture'});
  view.append(row.picture ? element('img', {loading: 'lazy', width: 320, height: 180, alt: `Map of ${row.name}`, src: row.picture}) : 'no picture');
  const links = [['overview', row.overview], ['report', row.run + '/report.json'], ['folder', row.run + '/']].filter(([, target]) => target);
  return element('article', {className: 'card'}, view,
                 element('h3', {}, ...(row.folder ? [words('span', row.folder, 'quiet')] : []), row.name),
                 words('p', `${grouped(row.path_m)} m in ${durationText(row.log_duration_s)}, ${grouped(row.scans)} scans`),
                 words('p', `${grouped(row.width_m)} × ${grouped(row.height_m)} m, ${row.cpu_s.toFixed(1)} s of CPU`),
                 ...(row.doubtful > 0 ? [words('p', `${grouped(row.doubtful)} doubtful scans`, 'doubt')] : []),
                 element('p', {className: 'links'}, ...links.map(([text, target]) => link(text, target))));
}

function totalsOf({rows, unmapped, hosts}) {
  const sum = (of) => rows.reduce((total, row) => total + of(row), 0);
  const ended = (outcome) => unmapped.filter((one) => one[1] === outcome).length;
  const path_m = sum((row) => row.path_m);
  const totals = [['maps', grouped(rows.length)], ...['refused', 'failed', 'missing'].map((outcome) => [outcome, ended(outcome), 'doubt']),
                  ['path', path_m < 10000 ? `${grouped(path_m)} m` : `${grouped(path_m / 1000)} km`],
                  ['time in the logs', durationText(sum((row) => row.log_duration_s))], ['scans', grouped(sum((row) => row.scans))],
                  ['CPU time', durationText(sum((row) => row.cpu_s))], ['machines', grouped(hosts)]];
  return element('dl', {className: 'totals'}, ...totals.filter(([, value]) => value !== 0).map(([name, value, className = '']) =>
      element('div', {}, words('dt', name), words('dd', value, className))));
}

function unmappedTable(unmapped) {
  const row = (tag, cells) => element('tr', {}, ...cells.map((cell) => words(tag, cell)));
  return element('section', {id: 'unmapped'}, element('div', {className: 'bar'}, element('h2', {}, 'Not mapped ', words('span', grouped(unmapped.length), 'quiet'))),
                 element('div', {className: 'table'}, element('table', {}, row('th', ['log', 'outcome', 'why', 'exit']),
                                                              ...unmapped.map((one) => row('td', one)))));
}

function showAtlas(atlas) {
  byId('main').hidden = byId('panel-toggle').hidden = byId('save').hidden = byId('help-open').hidden = true;
  byId('theme').addEventListener('click', () => theme.toggle());
  byId('full').addEventListener('click', toggleFullScreen);
  const find = element('input', {id: 'find', type: 'search', placeholder: 'part of a name', autocomplete: 'off'});
  const order = element('select', {id: 'order'}, ...Object.entries(kOrders).map(([value, [textContent]]) => element('option', {value, textContent})));
  const [shown, cards, turns] = [words('span', '', 'quiet'), element('div', {id: 'cards'}), element('nav', {className: 'turns', 'aria-label': 'Pages'})];
  let chosen = [];

  const show = (page) => {
    const last = Math.max(0, Math.ceil(chosen.length / kPerPage) - 1);
    cards.replaceChildren(...chosen.slice(page * kPerPage, (page + 1) * kPerPage).map(cardOf));
    shown.textContent = chosen.length === atlas.rows.length ? grouped(chosen.length) : `${grouped(chosen.length)} of ${grouped(atlas.rows.length)}`;
    const turn = (textContent, to) => {
      const button = element('button', {type: 'button', textContent, disabled: to < 0 || to > last});
      button.addEventListener('click', () => show(to));
      return button;
    };
    turns.replaceChildren(...(last > 0 ? [turn('Previous', page - 1), words('span', `page ${page + 1} of ${last + 1}`, 'quiet'), turn('Next', page + 1)] : []));
  };
  const choose = () => {
    const parts = find.value.toLowerCase().split(/\s+/);
    chosen = atlas.rows.filter((row) => parts.every((part) => `${row.folder}/${row.name} ${row.run}`.toLowerCase().includes(part)));
    const key = kOrders[order.value][1];
    if (key) chosen.sort((a, b) => key(b) - key(a));
    show(0);
  };
  find.addEventListener('input', choose);
  order.addEventListener('change', choose);
  byId('atlas').append(totalsOf(atlas), element('div', {className: 'bar'}, element('h2', {}, 'Maps ', shown), element('label', {}, 'Find ', find),
                                                element('label', {}, 'Order ', order)), cards, turns);
  if (atlas.unmapped.length > 0) byId('atlas').append(unmappedTable(atlas.unmapped));
  byId('atlas').hidden = false;
  choose();
}
