use clearway_experiments::motion::*; use clearway_experiments::motion_problems::*; use clearway_robot::Group; use std::path::Path; use std::time::Instant;
fn main(){
 let args: Vec<String>=std::env::args().collect();
 let dir=Path::new(&args[1]); let repeats: usize=args.get(2).map_or(9,|s|s.parse().unwrap());
 let problems=Problems::read(&dir.join("mbm_panda.json"),Cylinders::Peer).unwrap();
 let t=Instant::now();
 let group=Group::load(&dir.join("panda_spherized.urdf"),Some(&dir.join("panda.srdf")),Some(&problems.joints),&Default::default(),&[]).unwrap();
 let t1=t.elapsed();
 let planner=clearway_motion::MotionPlanner::new(group);
 eprintln!("load {:?} ready {:?} level {:?}",t1,t.elapsed(),planner.kernel.level);
 let b=&planner.kernel.body; eprintln!("balls {} parts {} pairs {} rows {} partners {}",b.balls.len(),b.parts.len(),b.pairs.len(),b.rows.len(),b.partners.len());
 let peer: serde_json::Value=serde_json::from_str(&std::fs::read_to_string(args.get(3).map(|s|s.into()).unwrap_or(dir.join("vamp_panda.json"))).unwrap()).unwrap();
 let mut p=std::collections::HashMap::new();
 for r in peer["rows"].as_array().unwrap(){ p.insert((r["set"].as_str().unwrap().to_string(),r["index"].as_u64().unwrap() as usize),(r["plan_us"].as_f64().unwrap_or(0.),r["simplify_us"].as_f64().unwrap_or(0.),r["cost"].as_f64().unwrap_or(0.),r["solved"].as_bool().unwrap_or(false)));}
 let s=Settings{repeats,..Default::default()};
 let mut out=vec![]; let mut file=std::io::BufWriter::new(std::fs::File::create("/tmp/mbm_rows.jsonl").unwrap());
 run_all(&planner,&problems,&s,|r|{ use std::io::Write; serde_json::to_writer(&mut file,r).unwrap(); writeln!(file).unwrap(); out.push(r.clone())});
 {use clearway_collision::lanes::*; let mut sc=planner.kernel.scratch(); let js=vec![Lanes::splat(0.3);7]; let mut best=f64::INFINITY; for _ in 0..50 {let t=Instant::now(); for _ in 0..200 {planner.kernel.place(&js,0.0,&mut sc);} best=best.min(t.elapsed().as_secs_f64()/200.0);} eprintln!("FK of 16: {:.0} ns",best*1e9);}
 for mode in [0] { use clearway_collision::lanes::*;  let mut total=0.0; let mut n=0;
 for p in problems.problems.iter().step_by(10) { let pieces=p.obstacles.iter().enumerate().flat_map(|(i,o)|Piece::of_solid(&o.solid,&o.root_from_solid,i as u32).collect::<Vec<_>>()).collect();
  let ob=Obstacles::new(pieces); let mut m=vec![]; ob.mask(|_|true,&mut m);
  let around=Around{obstacles:&ob,standing:&m,margin:0.0,hand:0.0,upright:None,never:&[]}; let mut s=planner.kernel.scratch(); 
  let ends:Vec<Vec<f64>>=(0..200).map(|i|p.start.iter().enumerate().map(|(j,v)|v+0.37*((i*7+j*3) as f64*1.7).sin()).collect()).collect();
  let mut best=f64::INFINITY; for _ in 0..5 {let t=Instant::now(); for e in &ends {planner.kernel.motion_free(&p.start,e,16.0,&around,&mut s);} best=best.min(t.elapsed().as_secs_f64());} total+=best; n+=ends.len(); }
  eprintln!("mode {mode}: {:.0} ns", total/n as f64*1e9); }
 edges(&planner,&problems,&out);
 let solved:Vec<&Row>=out.iter().filter(|r|r.solved).collect();
 for r in out.iter().filter(|r|!r.solved){eprintln!("unsolved {} {} {:?}",r.set,r.index,r.why)}
 let q=|v:&mut Vec<f64>,f:f64|{v.sort_by(f64::total_cmp);v[((v.len()-1) as f64*f) as usize]};
 let mut plan:Vec<f64>=solved.iter().map(|r|r.plan_us).collect(); let mut simp:Vec<f64>=solved.iter().map(|r|r.simplify_us).collect();
 let mean=|v:&Vec<f64>|v.iter().sum::<f64>()/v.len() as f64;
 eprintln!("solved {} plan median {:.1} mean {:.1} p95 {:.1}; simplify median {:.1} mean {:.1} p95 {:.1}",solved.len(),q(&mut plan,0.5),mean(&plan),q(&mut plan,0.95),q(&mut simp,0.5),mean(&simp),q(&mut simp,0.95));
 eprintln!("cost {:.3} -> {:.3}",mean(&solved.iter().map(|r|r.initial_cost.unwrap()).collect()),mean(&solved.iter().map(|r|r.cost.unwrap()).collect()));
 let mut ratio=vec![];let mut pr=vec![];
 for r in &solved{ let k=p[&(r.set.clone(),r.index)]; if k.3 {ratio.push((r.plan_us+r.simplify_us)/(k.0+k.1)); pr.push(k.0)}}
 eprintln!("ratio median {:.3} p90 {:.3}; peer p95 {:.1}",q(&mut ratio,0.5),q(&mut ratio,0.9),q(&mut pr,0.95));
}
#[allow(dead_code)] fn edges(planner:&clearway_motion::MotionPlanner, problems:&Problems, rows:&[Row]){
 use clearway_collision::lanes::*; 
 let (mut best_total,mut n)=(0.0,0u64); let mut motions=0u64; let mut invalid=(0.0,0u64);
 for (p,r) in problems.problems.iter().zip(rows){ if !r.solved {continue}
  let pieces=p.obstacles.iter().enumerate().flat_map(|(i,o)|Piece::of_solid(&o.solid,&o.root_from_solid,i as u32).collect::<Vec<_>>()).collect();
  let ob=Obstacles::new(pieces); let mut m=vec![]; ob.mask(|_|true,&mut m);
  let around=Around{obstacles:&ob,standing:&m,margin:0.0,hand:0.0,upright:None,never:&[]}; let mut s=planner.kernel.scratch();
  let mut best=f64::INFINITY;
  for _ in 0..7 { s.configurations=0; s.motions=0; let t=Instant::now(); for w in r.path.windows(2){ assert!(planner.kernel.motion_free(&w[0],&w[1],32.0,&around,&mut s)); } best=best.min(t.elapsed().as_secs_f64()); }
  best_total+=best; n+=s.configurations; motions+=s.motions;
  let mut best=f64::INFINITY; let mut k=0;
  for _ in 0..7 { let t=Instant::now(); k=0; for i in 0..20 { let a=&p.start; let b:Vec<f64>=a.iter().enumerate().map(|(j,v)|v+0.4*((i*7+j) as f64*1.7).sin()).collect(); if !planner.kernel.motion_free(a,&b,32.0,&around,&mut s){k+=1;} } best=best.min(t.elapsed().as_secs_f64()); }
  invalid.0+=best; invalid.1+=20; let _=k;
 }
 eprintln!("valid: {:.1} M configurations/s, {:.0} ns per motion of {:.1} configurations; mixed motions {:.0} ns", n as f64/best_total/1e6, best_total/motions as f64*1e9, n as f64/motions as f64, invalid.0/invalid.1 as f64*1e9);
}
