'use strict';
// Pictures in their places, tables that sort, points that say what they are, two pictures compared.
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const card = document.getElementById('card');
  const make = (tag, text, name) => {
    const element = document.createElement(tag);
    if (text !== undefined) element.textContent = text;
    if (name) element.className = name;
    return element;
  };

  for (const image of document.querySelectorAll('img[data-picture]')) {
    image.src = data.pictures[image.dataset.picture];
  }

  // Tables.
  const key = (row, column) => {
    const cell = row.cells[column];
    if (cell.dataset.key !== undefined) return Number(cell.dataset.key);
    const text = cell.textContent.trim();
    const number = Number.parseFloat(text.replace('−', '-'));
    return /^[−-]?[\d.]/.test(text) && !Number.isNaN(number) ? number : text;
  };
  const compare = (a, b) => {
    if (typeof a === 'number' && typeof b === 'number') return a - b;
    if (typeof a !== typeof b) return typeof a === 'number' ? -1 : 1;
    return a.localeCompare(b, undefined, { numeric: true });
  };
  for (const table of document.querySelectorAll('table')) {
    const heads = [...table.querySelectorAll('thead th')];
    heads.forEach((head, column) => {
      const button = make('button', head.textContent || '#', 'sort');
      button.type = 'button';
      head.replaceChildren(button);
      button.addEventListener('click', () => {
        const down = head.getAttribute('aria-sort') === 'ascending';
        heads.forEach((other) => other.removeAttribute('aria-sort'));
        head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
        const body = table.tBodies[0];
        const rows = [...body.rows].map((row) => [key(row, column), row]);
        rows.sort((a, b) => (down ? compare(b[0], a[0]) : compare(a[0], b[0])));
        body.append(...rows.map(([, row]) => row));
      });
    });
  }

  // Points of the charts.
  const show = (mark) => {
    const point = data.cases[mark.dataset.case].points[mark.dataset.point];
    const preset = ['sweep', point.setting.split(',')[0]].includes(point.preset) ? '' : ` (${point.preset})`;
    const list = make('dl');
    const lines = [['time', point.time], ['rel. RMSE', point.error], ['FLIP', point.flip]];
    for (const [name, value] of lines) list.append(make('dt', name), make('dd', value));
    const parts = [make('strong', point.name), make('p', point.setting + preset), list];
    if (point.picture !== null) {
      const image = make('img');
      image.src = data.pictures[point.picture];
      image.alt = '';
      parts.splice(0, 0, image);
    }
    if (point.dominated) parts.push(make('p', 'dominated: another setting is faster or better', 'faint'));
    parts.push(make('p', point.settings.join(' · '), 'faint'));
    card.replaceChildren(...parts);
    card.hidden = false;
    const at = mark.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = card;
    const room = document.documentElement.clientWidth;
    const right = at.right + 10 + width < room ? at.right + 10 : at.left - 10 - width;
    card.style.left = `${Math.max(8, Math.min(right, room - width - 8))}px`;
    const top = Math.min(at.top - 20, window.innerHeight - height - 8);
    const covers = right < 8 || right + width > room;
    card.style.top = `${Math.max(8, covers ? (at.bottom + 10 + height < window.innerHeight ? at.bottom + 10 : at.top - height - 10) : top)}px`;
  };
  const hide = () => { card.hidden = true; };

  // Two pictures of each case, chosen last.
  const chosen = data.cases.map(() => []);
  const pictureOf = (index, point) =>
    point === 'reference' ? data.cases[index].reference : data.cases[index].points[point].picture;
  const nameOf = (index, point) => {
    if (point === 'reference') return 'CPU reference';
    const { name, setting, error } = data.cases[index].points[point];
    return `${name}, ${setting}: ${error.split(' (')[0]}`;
  };
  const load = async (source) => {
    const image = new Image();
    image.src = source;
    await image.decode();
    return image;
  };
  const pixels = (image, width, height) => {
    const canvas = make('canvas');
    canvas.width = width;
    canvas.height = height;
    const context = canvas.getContext('2d', { willReadFrequently: true });
    context.drawImage(image, 0, 0, width, height);
    return context.getImageData(0, 0, width, height);
  };
  const difference = async (viewer, pair) => {
    const [a, b] = await Promise.all(pair.map((picture) => load(data.pictures[picture])));
    const [width, height] = [a.naturalWidth, a.naturalHeight];
    const [left, right] = [pixels(a, width, height), pixels(b, width, height)];
    let [sum, most] = [0, 0];
    for (let at = 0; at < left.data.length; at += 4) {
      let apart = 0;
      for (let channel = 0; channel < 3; channel += 1) {
        apart = Math.max(apart, Math.abs(left.data[at + channel] - right.data[at + channel]));
      }
      sum += apart;
      most = Math.max(most, apart);
      const share = apart < 1 ? 0 : Math.log(apart) / Math.log(255);
      const colour = data.scale[Math.round(share * (data.scale.length - 1))];
      left.data.set(colour, at);
    }
    const canvas = viewer.querySelector('canvas');
    canvas.width = width;
    canvas.height = height;
    canvas.getContext('2d').putImageData(left, 0, 0);
    const mean = (sum / (width * height)).toFixed(2);
    viewer.querySelector('.difference').textContent = `Difference: mean ${mean}, largest ${most} of 255 codes`;
    viewer.dataset.ready = 'true';
  };
  const view = (index) => {
    const viewer = document.querySelector(`.viewer[data-case="${index}"]`);
    if (!viewer) return;
    const [left, right] = chosen[index];
    document.querySelectorAll(`.pick[data-case="${index}"]`).forEach((button) => {
      button.setAttribute('aria-pressed', String(chosen[index].includes(button.dataset.point)));
    });
    document.querySelectorAll(`.hit[data-case="${index}"]`).forEach((mark) => {
      mark.classList.toggle('chosen', chosen[index].includes(mark.dataset.point));
    });
    if (right === undefined) return;
    viewer.querySelector('.under').src = data.pictures[pictureOf(index, left)];
    viewer.querySelector('.over').src = data.pictures[pictureOf(index, right)];
    viewer.querySelector('.left').textContent = `◀ ${nameOf(index, left)}`;
    viewer.querySelector('.right').textContent = `${nameOf(index, right)} ▶`;
    delete viewer.dataset.ready;
    difference(viewer, [pictureOf(index, left), pictureOf(index, right)]);
  };
  const choose = (index, point) => {
    const picture = pictureOf(index, point);
    if (picture === null || picture === undefined || chosen[index].includes(point)) return;
    chosen[index] = [...chosen[index], point].slice(-2);
    view(index);
  };

  for (const mark of document.querySelectorAll('.hit')) {
    mark.addEventListener('pointerenter', () => show(mark));
    mark.addEventListener('pointerleave', hide);
    mark.addEventListener('focus', () => show(mark));
    mark.addEventListener('blur', hide);
    mark.addEventListener('click', () => choose(Number(mark.dataset.case), mark.dataset.point));
    mark.addEventListener('keydown', (event) => {
      if (event.key === 'Enter' || event.key === ' ') {
        event.preventDefault();
        choose(Number(mark.dataset.case), mark.dataset.point);
      }
    });
  }
  for (const button of document.querySelectorAll('.pick')) {
    button.addEventListener('click', () => choose(Number(button.dataset.case), button.dataset.point));
  }
  document.addEventListener('keydown', (event) => { if (event.key === 'Escape') hide(); });
  // A mark that is reached by keyboard scrolls into view: its card goes with it.
  const follow = () => {
    const mark = document.activeElement;
    if (!card.hidden && mark && mark.matches('.hit:focus-visible')) show(mark);
    else hide();
  };
  document.addEventListener('scroll', follow, { passive: true });
  for (const viewer of document.querySelectorAll('.viewer')) {
    const range = viewer.querySelector('input');
    const move = () => viewer.style.setProperty('--divide', `${range.value / 10}%`);
    range.addEventListener('input', move);
    move();
    const index = Number(viewer.dataset.case);
    const { start, reference, points } = data.cases[index];
    const pictured = points.findIndex((point) => point.picture !== null);
    const other = start ?? pictured;
    const first = reference === null ? points.findIndex((p, at) => p.picture !== null && at !== other) : 'reference';
    if (first !== -1) choose(index, String(first));
    if (other !== -1) choose(index, String(other));
  }
})();
